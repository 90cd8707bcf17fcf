#pragma once

#include <selkie/laws/hyperelastic_law.h>

namespace selkie
{
  /// Saint Venant-Kirchhoff solid, equation (L.13): S linear in the
  /// Green-Lagrange strain E = (C - I)/2, W = Lambda/2 (tr E)^2 + G E:E. For
  /// large rotations and small strains; it softens in strong compression.
  class SaintVenantKirchhoff : public HyperelasticLaw
  {
  public:
    /// @param E Young's modulus, Pa
    /// @param nu Poisson's ratio
    /// @param rho reference density, kg/m^3
    /// @throw SceneError for a value out of range.
    SaintVenantKirchhoff(const double E, const double nu, const double rho);

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
