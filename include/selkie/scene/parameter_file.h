#pragma once

#include <deal.II/base/parameter_handler.h>

#include <string>
#include <vector>

/**
 * @file
 * From the text of a .prm and of `--set` options to the values of a
 * ParameterHandler. The text is split here and not by ParameterHandler, so
 * that names can be known before they are declared, and every error says in
 * one line where it is and what is allowed.
 */
namespace selkie
{
  /// One `set NAME = VALUE`, with the subsections around it.
  struct ParameterEntry
  {
    std::vector<std::string> sections;
    std::string              name;
    std::string              value;
    std::string              origin; ///< "file.prm:12" or "--set"

    /// "Section/Subsection/Name".
    std::string
    path() const;
  };

  using ParameterEntries = std::vector<ParameterEntry>;

  /// One parameter that a ParameterHandler knows.
  struct DeclaredParameter
  {
    std::string path, value, default_value, documentation;
    std::string allowed; ///< in words, e.g. "a number, at least 0"
  };

  /// The entries of a .prm file, in its order, then those of the overrides,
  /// "Section/Subsection/Name=value" each.
  /// @throw SceneError for a file that cannot be read, a line that is no
  /// assignment, subsections without end, a name that is set twice.
  ParameterEntries
  read_entries(const std::string              &file,
               const std::vector<std::string> &overrides);

  /// The last value given to a path, or the default.
  std::string
  value_of(const ParameterEntries &entries,
           const std::string      &path,
           const std::string      &default_value = "");

  /// The entry itself, or nullptr; the last one if there are several.
  const ParameterEntry *
  find_entry(const ParameterEntries &entries, const std::string &path);

  /// Gives the entries to @p prm. A SceneError thrown by an action of @p prm
  /// comes back with origin, parameter and value in front.
  /// @throw SceneError for a parameter that @p prm does not declare or a value
  /// that its pattern does not match.
  void
  apply_entries(dealii::ParameterHandler &prm, const ParameterEntries &entries);

  /// All parameters of @p prm in the order of their declaration.
  std::vector<DeclaredParameter>
  declared_parameters(const dealii::ParameterHandler &prm);

  /// The message of an error in one parameter, in one line.
  std::string
  parameter_message(const std::string &origin,
                    const std::string &path,
                    const std::string &value,
                    const std::string &why);

  /// A comma-separated list without blanks around its items; empty items are
  /// dropped.
  std::vector<std::string>
  split_list(const std::string &text);
} // namespace selkie
