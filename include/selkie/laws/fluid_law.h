#pragma once

#include <selkie/laws/kinematics.h>
#include <selkie/laws/law.h>
#include <selkie/laws/volumetric_law.h>

/**
 * @file
 * Weakly compressible fluids: a pressure that depends on J alone and a shear
 * viscosity that may depend on the rate of shear, with the component-free
 * forms that all of them share: tau = -J p I + 2 mu J d', d' = dev(sym l).
 * Theory: doc/theory.md, section 3; the paper's Lemmas 2-6.
 */
namespace selkie
{
  /// A fluid whose pressure depends on J and whose viscosity depends on the
  /// rate of shear sqrt(2 d':d').
  class FluidLaw : public Law, public VolumetricLaw
  {
  public:
    Phase
    phase() const override
    {
      return Phase::fluid;
    }

    /// Energy of compression per reference volume, J/m^3: dPsi/dJ = -p, zero
    /// at J = 1.
    /// @throw InvertedPoint if J <= 0.
    virtual double
    energy(const double J) const = 0;

    /// Dynamic viscosity and its derivative at one rate of shear.
    struct Viscosity
    {
      double value;     ///< mu, Pa s
      double slope = 0; ///< d mu / d(rate of shear), Pa s^2
    };

    /// @param shear_rate sqrt(2 d':d'), 1/s
    virtual Viscosity
    viscosity(const double shear_rate) const = 0;

    /// The largest viscosity at any rate, Pa s.
    virtual double
    largest_viscosity() const = 0;

    double
    shear_stiffness(const double alpha4) const override
    {
      return viscosity(0.).value * alpha4;
    }
  };


  /// sqrt(2 d':d') of a deviatoric rate of deformation @p d_dev, 1/s.
  double
  shear_rate(const Tensor<2, 3> &d_dev);

  /// Viscous Kirchhoff stress 2 mu J dev(sym l), Pa, equation (L.19).
  /// @param mu dynamic viscosity, Pa s
  /// @param J det F
  /// @param l velocity gradient, 1/s
  Tensor<2, 3>
  viscous_stress(const double mu, const double J, const Tensor<2, 3> &l);

  /// Tangent of r_a = viscous_stress g_a for a displacement increment of node
  /// b with dv_b = alpha4 du_b, per reference volume, equation (L.22), Pa/m^2.
  /// Not symmetric.
  /// @param mu_J mu J, Pa s
  /// @param d_dev dev(sym l), 1/s
  /// @param slope alpha4 I - l, 1/s
  /// @param g_a,g_b gradients on the current configuration, 1/m
  Tensor<2, 3>
  viscous_tangent(const double        mu_J,
                  const Tensor<2, 3> &d_dev,
                  const Tensor<2, 3> &slope,
                  const Tensor<1, 3> &g_a,
                  const Tensor<1, 3> &g_b);

  /// What a viscosity that depends on the rate of shear adds to that tangent,
  /// equation (L.22b), Pa/m^2.
  /// @param factor 4 J (d mu / d rate) / rate, Pa s^3
  Tensor<2, 3>
  shear_rate_tangent(const double        factor,
                     const Tensor<2, 3> &d_dev,
                     const Tensor<2, 3> &slope,
                     const Tensor<1, 3> &g_a,
                     const Tensor<1, 3> &g_b);

  /// Tangent of r_a = -J p(J) g_a for a displacement increment of node b, per
  /// reference volume, equation (L.21), Pa/m^2. Symmetric. With a pressure that
  /// does not follow J (mixed form) pass @p dp_dJ = 0.
  Tensor<2, 3>
  pressure_tangent_displacement(const double        p,
                                const double        J,
                                const double        dp_dJ,
                                const Tensor<1, 3> &g_a,
                                const Tensor<1, 3> &g_b);

  /// Power dissipated per reference volume 2 mu J d':d' >= 0, W/m^3,
  /// equation (L.20).
  double
  viscous_dissipation(const double mu, const double J, const Tensor<2, 3> &l);
} // namespace selkie
