#include <selkie/laws/law_table.h>

namespace selkie
{
  void
  declare_density(dealii::ParameterHandler &prm)
  {
    prm.declare_entry("Density",
                      "1000",
                      dealii::Patterns::Double(0.),
                      "Mass per reference volume; greater than 0. "
                      "Units: kg/m^3.");
  }


  void
  declare_elastic_constants(dealii::ParameterHandler &prm)
  {
    declare_density(prm);
    prm.declare_entry("Young modulus",
                      "1e6",
                      dealii::Patterns::Double(0.),
                      "Young's modulus at small strain; greater than 0. "
                      "Units: Pa.");
    prm.declare_entry("Poisson ratio",
                      "0.3",
                      dealii::Patterns::Double(0., 0.5),
                      "Poisson's ratio at small strain; at least 0 and less "
                      "than 0.5. Units: none.");
  }


  void
  declare_compressible_fluid(dealii::ParameterHandler &prm)
  {
    declare_density(prm);
    prm.declare_entry("Bulk modulus",
                      "2e6",
                      dealii::Patterns::Double(0.),
                      "Bulk modulus K at the reference pressure; greater "
                      "than 0. The speed of sound is sqrt(K / density); ten "
                      "times the fastest flow keeps the density within 1 %. "
                      "Water has 2.15e9. Units: Pa.");
    prm.declare_entry("Pressure exponent",
                      "7",
                      dealii::Patterns::Double(1.),
                      "n in p = p0 + K/n (J^-n - 1); greater than 1. "
                      "Units: none.");
    prm.declare_entry("Reference pressure",
                      "0",
                      dealii::Patterns::Double(),
                      "p0, the pressure at the reference density. "
                      "Units: Pa.");
  }


  const LawRow *
  find_law(const std::string &name)
  {
    for (const LawRow &row : law_table())
      if (row.name == name)
        return &row;
    return nullptr;
  }


  std::string
  law_names()
  {
    std::string names;
    for (const LawRow &row : law_table())
      names += (names.empty() ? "" : "|") + row.name;
    return names;
  }
} // namespace selkie
