#include <selkie/laws/isochoric_neo_hookean.h>
#include <selkie/laws/law_table.h>

#include <cmath>

namespace selkie
{
  IsochoricNeoHookean::IsochoricNeoHookean(const double E,
                                           const double nu,
                                           const double rho)
    : lame(lame_constants(E, nu))
    , rho(rho)
  {
    check_positive("Density", rho);
  }


  double
  IsochoricNeoHookean::density() const
  {
    return rho;
  }


  double
  IsochoricNeoHookean::sound_speed() const
  {
    return std::sqrt((lame.Lambda + 2. * lame.G) / rho);
  }


  double
  IsochoricNeoHookean::energy(const Invariants &invariants) const
  {
    const double J = invariants.J;
    check_not_inverted(J);
    const double K = bulk_modulus();
    return 0.5 * lame.G * (std::pow(J, -2. / 3.) * invariants.I1 - 3.) +
           0.25 * K * (J * J - 1. - 2. * std::log(J));
  }


  EnergyDerivatives
  IsochoricNeoHookean::shape_derivatives(const Invariants &invariants) const
  {
    const double J = invariants.J;
    check_not_inverted(J);
    const double shape = std::pow(J, -2. / 3.);

    EnergyDerivatives w;
    w.W1  = 0.5 * lame.G * shape;
    w.W1J = -1. / 3. * lame.G * shape / J;
    w.WJ  = -1. / 3. * lame.G * shape / J * invariants.I1;
    w.WJJ = 5. / 9. * lame.G * shape / (J * J) * invariants.I1;
    return w;
  }


  HyperelasticResponse
  IsochoricNeoHookean::shape_response(const Invariants &invariants) const
  {
    return response_from(shape_derivatives(invariants), invariants);
  }


  HyperelasticResponse
  IsochoricNeoHookean::response(const Invariants &invariants) const
  {
    EnergyDerivatives w = shape_derivatives(invariants);
    w.WJ -= pressure(invariants.J);
    w.WJJ -= dpressure_dJ(invariants.J);
    return response_from(w, invariants);
  }


  double
  IsochoricNeoHookean::pressure(const double J) const
  {
    check_not_inverted(J);
    return -0.5 * bulk_modulus() * (J - 1. / J);
  }


  double
  IsochoricNeoHookean::dpressure_dJ(const double J) const
  {
    check_not_inverted(J);
    return -0.5 * bulk_modulus() * (1. + 1. / (J * J));
  }


  /// The positive root of J^2 + 2 (p/K) J - 1.
  double
  IsochoricNeoHookean::J_of_pressure(const double p) const
  {
    const double s = p / bulk_modulus();
    return std::sqrt(1. + s * s) - s;
  }


  double
  IsochoricNeoHookean::dJ_dpressure(const double p) const
  {
    const double s = p / bulk_modulus();
    return (s / std::sqrt(1. + s * s) - 1.) / bulk_modulus();
  }


  double
  IsochoricNeoHookean::bulk_modulus() const
  {
    return lame.Lambda + 2. / 3. * lame.G;
  }


  double
  IsochoricNeoHookean::shear_stiffness(const double) const
  {
    return lame.G;
  }

  LawRow
  isochoric_neo_hookean_law()
  {
    return {
      "isochoric neo hookean",
      "Neo-Hookean solid with decoupled shape and volume changes, W = "
      "G/2 (J^(-2/3) tr C - 3) + K/4 (J^2 - 1 - 2 ln J), K = Lambda + 2/3 G: "
      "the law of deal.II's examples, for nearly incompressible solids.",
      &declare_elastic_constants,
      &create_elastic<IsochoricNeoHookean>};
  }
} // namespace selkie
