#pragma once

#include <selkie/laws/hyperelastic_law.h>

namespace selkie
{
  /// Neo-Hookean solid whose shape and volume changes are decoupled:
  /// W = G/2 (J^{-2/3} tr C - 3) + K/4 (J^2 - 1 - 2 ln J), K = Lambda + 2/3 G.
  /// The law of deal.II's step-44 and of its code gallery's Cook membrane.
  class IsochoricNeoHookean : public DecoupledLaw
  {
  public:
    /// @param E Young's modulus, Pa
    /// @param nu Poisson's ratio
    /// @param rho reference density, kg/m^3
    /// @throw SceneError for a value out of range.
    IsochoricNeoHookean(const double E, const double nu, const double rho);

    double
    density() const override;

    double
    sound_speed() const override;

    double
    energy(const Invariants &invariants) const override;

    HyperelasticResponse
    response(const Invariants &invariants) const override;

    HyperelasticResponse
    shape_response(const Invariants &invariants) const override;

    double
    pressure(const double J) const override;

    double
    dpressure_dJ(const double J) const override;

    double
    J_of_pressure(const double p) const override;

    double
    dJ_dpressure(const double p) const override;

    double
    bulk_modulus() const override;

    double
    shear_stiffness(const double alpha4) const override;

  private:
    EnergyDerivatives
    shape_derivatives(const Invariants &invariants) const;

    const LameConstants lame;
    const double        rho;
  };
} // namespace selkie
