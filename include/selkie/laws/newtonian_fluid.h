#pragma once

#include <selkie/laws/fluid_law.h>

namespace selkie
{
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
    bulk_modulus() const override;

    Viscosity
    viscosity(const double shear_rate) const override;

    double
    largest_viscosity() const override;

  private:
    /// J^-n = 1 + n (p - p0) / K.
    /// @throw NumericalFailure unless it is positive.
    double
    compression(const double p) const;

    const double K, n, p0, mu, rho;
  };
} // namespace selkie
