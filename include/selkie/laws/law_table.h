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
  };

  /// All laws, in the order of the parameter reference. A new law is a header,
  /// a source and a row here.
  const std::vector<LawRow> &
  law_table();

  /// The row of the law called @p name; nullptr if there is none.
  const LawRow *
  find_law(const std::string &name);

  /// "name|name|..." for dealii::Patterns::Selection.
  std::string
  law_names();
} // namespace selkie
