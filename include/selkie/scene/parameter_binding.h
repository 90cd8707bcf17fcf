#pragma once

#include <selkie/base/expression.h>
#include <selkie/scene/shapes.h>

#include <deal.II/base/parameter_handler.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

/**
 * @file
 * What ParameterHandler::add_parameter does for numbers, for the other things
 * that a scene holds: each declares a parameter in the current subsection and
 * ties it to a variable.
 */
namespace selkie
{
  /// A choice between named values; the default is the variable's value.
  template <typename T>
  void
  add_choice(dealii::ParameterHandler                     &prm,
             const std::string                            &name,
             T                                            &variable,
             const std::vector<std::pair<std::string, T>> &choices,
             const std::string                            &documentation)
  {
    std::string names, default_name;
    for (const auto &[word, value] : choices)
      {
        names += (names.empty() ? "" : "|") + word;
        if (value == variable && default_name.empty())
          default_name = word;
      }
    prm.declare_entry(name,
                      default_name,
                      dealii::Patterns::Selection(names),
                      documentation);
    prm.add_action(name, [&variable, choices](const std::string &text) {
      for (const auto &[word, value] : choices)
        if (word == text)
          variable = value;
    });
  }


  /// A shape; null if the text is empty, which is the default.
  template <int dim>
  void
  add_shape(dealii::ParameterHandler          &prm,
            const std::string                 &name,
            std::shared_ptr<const Shape<dim>> &variable,
            const std::string                 &documentation)
  {
    prm.declare_entry(name, "", dealii::Patterns::Anything(), documentation);
    prm.add_action(name, [&variable](const std::string &text) {
      variable = text.empty() ? nullptr : make_shape<dim>(text);
    });
  }


  /// A vector function; null if the text is empty, which is the default.
  template <int dim>
  void
  add_function(dealii::ParameterHandler               &prm,
               const std::string                      &name,
               std::shared_ptr<VectorExpression<dim>> &variable,
               const std::string                      &documentation)
  {
    prm.declare_entry(name, "", dealii::Patterns::Anything(), documentation);
    prm.add_action(name, [&variable](const std::string &text) {
      variable =
        text.empty() ? nullptr : std::make_shared<VectorExpression<dim>>(text);
    });
  }


  /// The index of @p text in @p names.
  /// @throw SceneError that lists the names, of which @p what says what they
  /// are.
  unsigned int
  index_of(const std::string              &text,
           const std::vector<std::string> &names,
           const std::string              &what);


  /// A parameter whose value is one of some names; the first one is default.
  void
  add_index(dealii::ParameterHandler       &prm,
            const std::string              &name,
            unsigned int                   &variable,
            const std::vector<std::string> &names,
            const std::string              &what,
            const std::string              &documentation);
} // namespace selkie
