#include <selkie/laws/law_table.h>
#include <selkie/laws/mooney_rivlin.h>

#include <cmath>
#include <sstream>

namespace selkie
{
  namespace
  {
    using dealii::ParameterHandler;
    using dealii::Patterns::Double;

    void
    declare_mooney_rivlin(ParameterHandler &prm)
    {
      declare_density(prm);
      prm.declare_entry("Mooney C10",
                        "1e5",
                        Double(0.),
                        "Factor of I1 - 3 in the energy; greater than 0. The "
                        "shear modulus is 2 (C10 + C01). Units: Pa.");
      prm.declare_entry("Mooney C01",
                        "2e4",
                        Double(0.),
                        "Factor of I2 - 3 in the energy; at least 0. "
                        "Units: Pa.");
      prm.declare_entry("Bulk modulus",
                        "1e6",
                        Double(0.),
                        "Bulk modulus at small strain; at least 4/3 C10 + 16/3 "
                        "C01. Units: Pa.");
    }


    std::unique_ptr<const Law>
    create_mooney_rivlin(ParameterHandler &prm)
    {
      return std::make_unique<const MooneyRivlin>(prm.get_double("Mooney C10"),
                                                  prm.get_double("Mooney C01"),
                                                  prm.get_double(
                                                    "Bulk modulus"),
                                                  prm.get_double("Density"));
    }
  } // namespace


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

  LawRow
  mooney_rivlin_law()
  {
    return {
      "mooney rivlin",
      "Compressible Mooney-Rivlin solid, W = C10 (I1 - 3) + C01 (I2 - 3) - "
      "(2 C10 + 4 C01) ln J + (K - 4/3 C10 - 16/3 C01)/4 (J^2 - 1 - 2 ln J): "
      "rubber.",
      &declare_mooney_rivlin,
      &create_mooney_rivlin};
  }
} // namespace selkie
