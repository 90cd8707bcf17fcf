#pragma once

#include <selkie/laws/kinematics.h>
#include <selkie/laws/law.h>

/**
 * @file
 * The weakly compressible Newtonian fluid and the component-free forms that
 * every fluid with a shear viscosity shares: tau = -J p I + 2 mu J dev(sym l).
 * Theory: doc/theory.md, section 3; the paper's Lemmas 2-6.
 */
namespace selkie
{
  /// A fluid whose pressure depends on J alone.
  class FluidLaw : public Law
  {
  public:
    Phase
    phase() const override
    {
      return Phase::fluid;
    }

    /// Pressure p(J), Pa, positive in compression.
    /// @throw InvertedPoint if J <= 0.
    virtual double
    pressure(const double J) const = 0;

    /// dp/dJ, Pa; negative.
    /// @throw InvertedPoint if J <= 0.
    virtual double
    dpressure_dJ(const double J) const = 0;

    /// The volume ratio at which the pressure is @p p (Pa).
    /// @throw NumericalFailure if the law never reaches that tension.
    virtual double
    J_of_pressure(const double p) const = 0;

    /// dJ/dp at the pressure @p p (Pa), 1/Pa; negative.
    /// @throw NumericalFailure as J_of_pressure().
    virtual double
    dJ_dpressure(const double p) const = 0;

    /// Energy of compression per reference volume, J/m^3: dPsi/dJ = -p, zero
    /// at J = 1.
    /// @throw InvertedPoint if J <= 0.
    virtual double
    energy(const double J) const = 0;

    /// Dynamic viscosity mu, Pa s.
    virtual double
    viscosity() const = 0;

    /// Bulk modulus -J dp/dJ at J = 1, Pa.
    virtual double
    bulk_modulus() const = 0;
  };


  /// p = p0 + K/n (J^-n - 1), equations (L.15)-(L.18), with constant viscosity.
  class NewtonianFluid : public FluidLaw
  {
  public:
    /// @param K bulk modulus at J = 1, Pa
    /// @param n exponent, greater than 1
    /// @param p0 pressure at J = 1, Pa
    /// @param mu dynamic viscosity, Pa s
    /// @param rho density at J = 1, kg/m^3
    /// @throw SceneError for a value out of range.
    NewtonianFluid(const double K,
                   const double n,
                   const double p0,
                   const double mu,
                   const double rho);

    double
    density() const override;

    double
    sound_speed() const override;

    double
    pressure(const double J) const override;

    double
    dpressure_dJ(const double J) const override;

    double
    J_of_pressure(const double p) const override;

    double
    dJ_dpressure(const double p) const override;

    double
    energy(const double J) const override;

    double
    viscosity() const override;

    double
    bulk_modulus() const override;

  private:
    /// J^-n = 1 + n (p - p0) / K.
    /// @throw NumericalFailure unless it is positive.
    double
    compression(const double p) const;

    const double K, n, p0, mu, rho;
  };


  /// Viscous Kirchhoff stress 2 mu J dev(sym l), Pa, equation (L.19).
  /// @param mu dynamic viscosity, Pa s
  /// @param J det F
  /// @param l velocity gradient, 1/s
  Tensor<2, 3>
  viscous_stress(const double mu, const double J, const Tensor<2, 3> &l);

  /// Tangent of r_a = viscous_stress g_a for a displacement increment of node
  /// b with dv_b = alpha4 du_b, per reference volume, equation (L.22), Pa/m^2.
  /// Not symmetric.
  /// @param alpha4 Newmark's alpha4, 1/s
  /// @param g_a,g_b gradients on the current configuration, 1/m
  Tensor<2, 3>
  viscous_tangent(const double        mu,
                  const double        J,
                  const Tensor<2, 3> &l,
                  const double        alpha4,
                  const Tensor<1, 3> &g_a,
                  const Tensor<1, 3> &g_b);

  /// The same for a loop over pairs of nodes, with what does not depend on the
  /// pair computed before.
  /// @param mu_J mu J, Pa s
  /// @param d_dev dev(sym l), 1/s
  /// @param slope alpha4 I - l, 1/s
  Tensor<2, 3>
  viscous_tangent(const double        mu_J,
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
