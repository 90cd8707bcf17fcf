#pragma once

#include <selkie/laws/kinematics.h>
#include <selkie/laws/law.h>
#include <selkie/laws/volumetric_law.h>

#include <array>

/**
 * @file
 * Isotropic hyperelasticity in spatial form. A law supplies eleven scalars;
 * stress and tangent are written here once for all of them. Theory:
 * doc/theory.md, section 2; the paper's (B16)-(B17).
 */
namespace selkie
{
  /// Stress and tangent of an isotropic hyperelastic law at one state.
  struct HyperelasticResponse
  {
    /// tau = stress[0] I + stress[1] b + stress[2] b^2, Pa.
    std::array<double, 3> stress;
    /// Gamma[k-1] is Gamma_k of equation (L.8), Pa.
    std::array<double, 8> Gamma;
  };

  /// A solid with a stored energy that depends on the invariants of b.
  class HyperelasticLaw : public Law
  {
  public:
    Phase
    phase() const override
    {
      return Phase::solid;
    }

    /// Stored energy per reference volume W, J/m^3; zero at F = I.
    /// @throw InvertedPoint if J <= 0.
    virtual double
    energy(const Invariants &invariants) const = 0;

    /// Coefficients of stress and tangent, equations (L.6) and (L.8), Pa.
    /// @throw InvertedPoint if J <= 0.
    virtual HyperelasticResponse
    response(const Invariants &invariants) const = 0;
  };

  /// One whose energy is the sum of that of the shape J^{-1/3} F and that of
  /// the volume ratio J.
  class DecoupledLaw : public HyperelasticLaw, public VolumetricLaw
  {
  public:
    /// Coefficients of stress and tangent of the energy of the shape, Pa.
    /// @throw InvertedPoint if J <= 0.
    virtual HyperelasticResponse
    shape_response(const Invariants &invariants) const = 0;
  };

  /// The two Lame constants, Pa.
  struct LameConstants
  {
    double Lambda; ///< first constant
    double G;      ///< shear modulus
  };

  /// Lame constants from Young's modulus (Pa) and Poisson's ratio.
  /// @throw SceneError unless E > 0 and 0 <= nu < 1/2.
  LameConstants
  lame_constants(const double E, const double nu);

  /// First and second derivatives of W(I1, I2, J), Pa.
  struct EnergyDerivatives
  {
    double W1 = 0., W2 = 0., WJ = 0.;
    double W11 = 0., W12 = 0., W22 = 0.;
    double W1J = 0., W2J = 0., WJJ = 0.;
  };

  /// The response of a law given as W(I1, I2, J), equations (L.6) and (L.9).
  HyperelasticResponse
  response_from(const EnergyDerivatives &derivatives,
                const Invariants        &invariants);

  /// Kirchhoff stress tau, Pa, equation (L.6).
  inline Tensor<2, 3>
  kirchhoff_stress(const HyperelasticResponse &response, const Tensor<2, 3> &b)
  {
    const auto  &s   = response.stress;
    Tensor<2, 3> tau = s[1] * b;
    if (s[2] != 0.)
      tau += s[2] * (b * b);
    for (unsigned int i = 0; i < 3; ++i)
      tau[i][i] += s[0];
    return tau;
  }

  /// Tangent K_ab / V0 of r_a = tau g_a for a displacement increment of node b,
  /// Pa/m^2, equation (L.10), i.e. the paper's (B16)-(B17) pushed forward.
  /// @param response at the current state
  /// @param tau kirchhoff_stress(response, b)
  /// @param b left Cauchy-Green tensor
  /// @param g_a,g_b gradients of the two shape functions on the current
  ///   configuration, 1/m
  /// @return 3x3, rows for node a, columns for node b; K_ab = K_ba^T.
  Tensor<2, 3>
  hyperelastic_tangent(const HyperelasticResponse &response,
                       const Tensor<2, 3>         &tau,
                       const Tensor<2, 3>         &b,
                       const Tensor<1, 3>         &g_a,
                       const Tensor<1, 3>         &g_b);
} // namespace selkie
