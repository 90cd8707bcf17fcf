#pragma once

#include <selkie/laws/hyperelastic_law.h>

namespace selkie
{
  /// The paper's neo-Hookean solid (B18), equations (L.11)-(L.12):
  /// W = G/2 (tr C - 3) - G ln J + Lambda/4 (J^2 - 1 - 2 ln J).
  class NeoHookean : public HyperelasticLaw
  {
  public:
    /// @param E Young's modulus, Pa
    /// @param nu Poisson's ratio
    /// @param rho reference density, kg/m^3
    /// @throw SceneError for a value out of range.
    NeoHookean(const double E, const double nu, const double rho);

    double
    density() const override;

    double
    sound_speed() const override;

    double
    energy(const Invariants &invariants) const override;

    HyperelasticResponse
    response(const Invariants &invariants) const override;

  private:
    const LameConstants lame;
    const double        rho;
  };
} // namespace selkie
