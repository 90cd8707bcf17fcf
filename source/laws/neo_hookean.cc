#include <selkie/laws/law_table.h>
#include <selkie/laws/neo_hookean.h>

#include <cmath>

namespace selkie
{
  NeoHookean::NeoHookean(const double E, const double nu, const double rho)
    : lame(lame_constants(E, nu))
    , rho(rho)
  {
    check_positive("Density", rho);
  }


  double
  NeoHookean::density() const
  {
    return rho;
  }


  double
  NeoHookean::sound_speed() const
  {
    return std::sqrt((lame.Lambda + 2. * lame.G) / rho);
  }


  double
  NeoHookean::energy(const Invariants &invariants) const
  {
    const double J = invariants.J;
    check_not_inverted(J);
    const double ln_J = std::log(J);
    return lame.G * (0.5 * (invariants.I1 - 3.) - ln_J) +
           0.25 * lame.Lambda * (J * J - 1. - 2. * ln_J);
  }


  HyperelasticResponse
  NeoHookean::response(const Invariants &invariants) const
  {
    const double J = invariants.J;
    check_not_inverted(J);
    const double J2         = J * J;
    const double volumetric = 0.5 * lame.Lambda * (J2 - 1.);

    HyperelasticResponse response{};
    response.stress[0] = volumetric - lame.G;
    response.stress[1] = lame.G;
    response.Gamma[0]  = lame.Lambda * J2;
    response.Gamma[7]  = 2. * (lame.G - volumetric);
    return response;
  }

  LawRow
  neo_hookean_law()
  {
    return {"neo hookean",
            "Compressible neo-Hookean solid, W = G/2 (tr C - 3) - G ln J + "
            "Lambda/4 (J^2 - 1 - 2 ln J). The solid of choice at large strain.",
            &declare_elastic_constants,
            &create_elastic<NeoHookean>};
  }
} // namespace selkie
