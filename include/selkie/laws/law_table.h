#pragma once

#include <selkie/laws/law.h>

#include <deal.II/base/parameter_handler.h>

#include <memory>
#include <string>
#include <vector>

namespace selkie
{
  /// One law that a scene can name.
  struct LawRow
  {
    /// How a scene names it.
    std::string name;

    /// One or two sentences for the parameter reference.
    std::string documentation;

    /// Declares the law's parameters in the current subsection.
    void (*declare)(dealii::ParameterHandler &prm);

    /// Reads them from the current subsection.
    /// @throw SceneError for a value out of range.
    std::unique_ptr<const Law> (*create)(dealii::ParameterHandler &prm);

    /// The effect without which the law makes no sense, or "".
    std::string needs_effect = "";
  };

  /// Parameters that laws share: Density, and with it Young's modulus and
  /// Poisson's ratio, or what a weakly compressible pressure needs.
  void
  declare_density(dealii::ParameterHandler &prm);
  void
  declare_elastic_constants(dealii::ParameterHandler &prm);
  void
  declare_compressible_fluid(dealii::ParameterHandler &prm);

  /// For laws constructed from (E, nu, rho).
  template <typename ElasticLaw>
  std::unique_ptr<const Law>
  create_elastic(dealii::ParameterHandler &prm)
  {
    return std::make_unique<const ElasticLaw>(prm.get_double("Young modulus"),
                                              prm.get_double("Poisson ratio"),
                                              prm.get_double("Density"));
  }

  // One row a law; each is defined in the source of its name.
  LawRow
  neo_hookean_law();
  LawRow
  isochoric_neo_hookean_law();
  LawRow
  saint_venant_kirchhoff_law();
  LawRow
  mooney_rivlin_law();
  LawRow
  newtonian_fluid_law();
  LawRow
  bingham_fluid_law();

  /// All laws, in the order of the parameter reference. A new law is a source
  /// (with a header if others need its class), its declaration above and its
  /// row in law_table.cc.
  const std::vector<LawRow> &
  law_table();

  /// The row of the law called @p name; nullptr if there is none.
  const LawRow *
  find_law(const std::string &name);

  /// "name|name|..." for dealii::Patterns::Selection.
  std::string
  law_names();
} // namespace selkie
