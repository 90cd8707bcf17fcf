#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <memory>
#include <string>
#include <vector>

namespace selkie
{
  /**
   * A scalar function that a scene gives as text, evaluated by muParser.
   *
   * Variables: the present position `x, y, z`, the reference position
   * `X, Y, Z` (all m) and the time `t` (s); `pi` is known. In 2D, z and Z are
   * zero. Throws SceneError with the text and muParser's reason when the text
   * cannot be parsed.
   */
  class Expression
  {
  public:
    explicit Expression(const std::string &text = "0");
    ~Expression();
    Expression(Expression &&) noexcept;
    Expression &
    operator=(Expression &&) noexcept;

    template <int dim>
    double
    value(const dealii::Point<dim> &x,
          const double              t,
          const dealii::Point<dim> &X = dealii::Point<dim>()) const;

    const std::string &
    text() const;

  private:
    struct Parser;
    std::unique_ptr<Parser> parser;
  };

  /// One expression per component, separated by semicolons in the scene.
  template <int dim>
  class VectorExpression
  {
  public:
    /// Throws SceneError unless the text has exactly dim components.
    explicit VectorExpression(const std::string &text);

    dealii::Tensor<1, dim>
    value(const dealii::Point<dim> &x,
          const double              t,
          const dealii::Point<dim> &X = dealii::Point<dim>()) const;

  private:
    std::vector<Expression> components;
  };
} // namespace selkie
