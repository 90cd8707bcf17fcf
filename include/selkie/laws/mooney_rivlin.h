#pragma once

#include <selkie/laws/hyperelastic_law.h>

namespace selkie
{
  /// Compressible Mooney-Rivlin solid, equation (L.14):
  /// W = C10 (I1 - 3) + C01 (I2 - 3) - (2 C10 + 4 C01) ln J
  ///     + Lambda'/4 (J^2 - 1 - 2 ln J),
  /// Lambda' = K - 4/3 C10 - 16/3 C01. Stress-free at F = I; at small strain
  /// its shear modulus is 2 (C10 + C01) and its bulk modulus K. With C01 = 0 it
  /// is NeoHookean.
  class MooneyRivlin : public HyperelasticLaw
  {
  public:
    /// @param C10 factor of I1, Pa, positive
    /// @param C01 factor of I2, Pa, at least 0
    /// @param K bulk modulus, Pa, at least 4/3 C10 + 16/3 C01 (so that W is
    ///   polyconvex)
    /// @param rho reference density, kg/m^3
    /// @throw SceneError for a value out of range.
    MooneyRivlin(const double C10,
                 const double C01,
                 const double K,
                 const double rho);

    double
    density() const override;

    double
    sound_speed() const override;

    double
    energy(const Invariants &invariants) const override;

    HyperelasticResponse
    response(const Invariants &invariants) const override;

  private:
    const double C10, C01, K, rho;
    const double Lambda; ///< Lambda' of (L.14), Pa
  };
} // namespace selkie
