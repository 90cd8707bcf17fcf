#include <selkie/laws/isochoric_neo_hookean.h>
#include <selkie/laws/law_table.h>
#include <selkie/laws/mooney_rivlin.h>
#include <selkie/laws/neo_hookean.h>
#include <selkie/laws/newtonian_fluid.h>
#include <selkie/laws/saint_venant_kirchhoff.h>

namespace selkie
{
  namespace
  {
    using dealii::ParameterHandler;
    using dealii::Patterns::Double;

    void
    declare_density(ParameterHandler &prm)
    {
      prm.declare_entry("Density",
                        "1000",
                        Double(0.),
                        "Mass per reference volume; greater than 0. "
                        "Units: kg/m^3.");
    }


    void
    declare_elastic_constants(ParameterHandler &prm)
    {
      declare_density(prm);
      prm.declare_entry("Young modulus",
                        "1e6",
                        Double(0.),
                        "Young's modulus at small strain; greater than 0. "
                        "Units: Pa.");
      prm.declare_entry("Poisson ratio",
                        "0.3",
                        Double(0., 0.5),
                        "Poisson's ratio at small strain; at least 0 and less "
                        "than 0.5. Units: none.");
    }


    /// For laws constructed from (E, nu, rho).
    template <typename ElasticLaw>
    std::unique_ptr<const Law>
    create_elastic(ParameterHandler &prm)
    {
      return std::make_unique<const ElasticLaw>(prm.get_double("Young modulus"),
                                                prm.get_double("Poisson ratio"),
                                                prm.get_double("Density"));
    }


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


    void
    declare_newtonian_fluid(ParameterHandler &prm)
    {
      declare_density(prm);
      prm.declare_entry("Bulk modulus",
                        "2e6",
                        Double(0.),
                        "Bulk modulus K at the reference pressure; greater "
                        "than 0. The speed of sound is sqrt(K / density); ten "
                        "times the fastest flow keeps the density within 1 %. "
                        "Water has 2.15e9. Units: Pa.");
      prm.declare_entry("Pressure exponent",
                        "7",
                        Double(1.),
                        "n in p = p0 + K/n (J^-n - 1); greater than 1. "
                        "Units: none.");
      prm.declare_entry("Reference pressure",
                        "0",
                        Double(),
                        "p0, the pressure at the reference density. "
                        "Units: Pa.");
      prm.declare_entry("Viscosity",
                        "1e-3",
                        Double(0.),
                        "Dynamic shear viscosity; at least 0. Units: Pa s.");
    }


    std::unique_ptr<const Law>
    create_newtonian_fluid(ParameterHandler &prm)
    {
      return std::make_unique<const NewtonianFluid>(
        prm.get_double("Bulk modulus"),
        prm.get_double("Pressure exponent"),
        prm.get_double("Reference pressure"),
        prm.get_double("Viscosity"),
        prm.get_double("Density"));
    }
  } // namespace


  const std::vector<LawRow> &
  law_table()
  {
    static const std::vector<LawRow> table = {
      {"neo hookean",
       "Compressible neo-Hookean solid, W = G/2 (tr C - 3) - G ln J + "
       "Lambda/4 (J^2 - 1 - 2 ln J). The solid of choice at large strain.",
       &declare_elastic_constants,
       &create_elastic<NeoHookean>},
      {"isochoric neo hookean",
       "Neo-Hookean solid with decoupled shape and volume changes, W = "
       "G/2 (J^(-2/3) tr C - 3) + K/4 (J^2 - 1 - 2 ln J), K = Lambda + 2/3 G: "
       "the law of deal.II's examples, for nearly incompressible solids.",
       &declare_elastic_constants,
       &create_elastic<IsochoricNeoHookean>},
      {"saint venant kirchhoff",
       "Stress linear in the Green-Lagrange strain: for large rotations and "
       "small strains. It softens and fails in strong compression.",
       &declare_elastic_constants,
       &create_elastic<SaintVenantKirchhoff>},
      {"mooney rivlin",
       "Compressible Mooney-Rivlin solid, W = C10 (I1 - 3) + C01 (I2 - 3) - "
       "(2 C10 + 4 C01) ln J + (K - 4/3 C10 - 16/3 C01)/4 (J^2 - 1 - 2 ln J): "
       "rubber.",
       &declare_mooney_rivlin,
       &create_mooney_rivlin},
      {"newtonian fluid",
       "Weakly compressible fluid with p = p0 + K/n (J^-n - 1) and a constant "
       "shear viscosity.",
       &declare_newtonian_fluid,
       &create_newtonian_fluid}};
    return table;
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
