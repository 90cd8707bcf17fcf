#include <selkie/laws/law_table.h>
#include <selkie/laws/saint_venant_kirchhoff.h>

#include <cmath>

namespace selkie
{
  SaintVenantKirchhoff::SaintVenantKirchhoff(const double E,
                                             const double nu,
                                             const double rho)
    : lame(lame_constants(E, nu))
    , rho(rho)
  {
    check_positive("Density", rho);
  }


  double
  SaintVenantKirchhoff::density() const
  {
    return rho;
  }


  double
  SaintVenantKirchhoff::sound_speed() const
  {
    return std::sqrt((lame.Lambda + 2. * lame.G) / rho);
  }


  double
  SaintVenantKirchhoff::energy(const Invariants &invariants) const
  {
    check_not_inverted(invariants.J);
    const double i1 = invariants.I1 - 3.;
    const double i2 = invariants.I2 - 3.;
    return lame.Lambda / 8. * i1 * i1 +
           lame.G / 4. * (i1 * (i1 + 4.) - 2. * i2);
  }


  HyperelasticResponse
  SaintVenantKirchhoff::response(const Invariants &invariants) const
  {
    check_not_inverted(invariants.J);
    EnergyDerivatives w;
    w.W1 = lame.Lambda / 4. * (invariants.I1 - 3.) +
           lame.G / 2. * (invariants.I1 - 1.);
    w.W2  = -lame.G / 2.;
    w.W11 = lame.Lambda / 4. + lame.G / 2.;
    return response_from(w, invariants);
  }

  LawRow
  saint_venant_kirchhoff_law()
  {
    return {
      "saint venant kirchhoff",
      "Stress linear in the Green-Lagrange strain: for large rotations and "
      "small strains. It softens and fails in strong compression.",
      &declare_elastic_constants,
      &create_elastic<SaintVenantKirchhoff>};
  }
} // namespace selkie
