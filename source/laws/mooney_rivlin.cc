#include <selkie/laws/mooney_rivlin.h>

#include <cmath>
#include <sstream>

namespace selkie
{
  MooneyRivlin::MooneyRivlin(const double C10,
                             const double C01,
                             const double K,
                             const double rho)
    : C10(C10)
    , C01(C01)
    , K(K)
    , rho(rho)
    , Lambda(K - 4. / 3. * C10 - 16. / 3. * C01)
  {
    check_positive("Mooney C10", C10);
    check_parameter(C01 >= 0. && std::isfinite(C01),
                    "Mooney C01",
                    C01,
                    "at least 0 and finite");
    std::ostringstream allowed;
    allowed << "finite and at least 4/3 C10 + 16/3 C01 = "
            << 4. / 3. * C10 + 16. / 3. * C01;
    check_parameter(Lambda >= 0. && std::isfinite(K),
                    "Bulk modulus",
                    K,
                    allowed.str());
    check_positive("Density", rho);
  }


  double
  MooneyRivlin::density() const
  {
    return rho;
  }


  double
  MooneyRivlin::sound_speed() const
  {
    return std::sqrt((K + 8. / 3. * (C10 + C01)) / rho);
  }


  double
  MooneyRivlin::energy(const Invariants &invariants) const
  {
    const double J = invariants.J;
    check_not_inverted(J);
    const double ln_J = std::log(J);
    return C10 * (invariants.I1 - 3.) + C01 * (invariants.I2 - 3.) -
           (2. * C10 + 4. * C01) * ln_J +
           0.25 * Lambda * (J * J - 1. - 2. * ln_J);
  }


  HyperelasticResponse
  MooneyRivlin::response(const Invariants &invariants) const
  {
    const double J = invariants.J;
    check_not_inverted(J);
    const double log_factor = 2. * C10 + 4. * C01;
    const double J2         = J * J;

    EnergyDerivatives w;
    w.W1  = C10;
    w.W2  = C01;
    w.WJ  = (0.5 * Lambda * (J2 - 1.) - log_factor) / J;
    w.WJJ = (0.5 * Lambda * (J2 + 1.) + log_factor) / J2;
    return response_from(w, invariants);
  }
} // namespace selkie
