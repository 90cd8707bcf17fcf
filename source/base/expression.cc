#include <selkie/base/exceptions.h>
#include <selkie/base/expression.h>

#include <deal.II/base/numbers.h>
#include <deal.II/base/utilities.h>

#include <muParser.h>

namespace selkie
{
  using namespace dealii;

  struct Expression::Parser
  {
    std::string text;
    mu::Parser  parser;
    // x, y, z, X, Y, Z, t: muParser keeps pointers to these.
    double variables[7] = {0, 0, 0, 0, 0, 0, 0};
  };

  Expression::Expression(const std::string &text)
    : parser(std::make_unique<Parser>())
  {
    static const char *names[] = {"x", "y", "z", "X", "Y", "Z", "t"};
    parser->text               = text;
    try
      {
        for (unsigned int i = 0; i < 7; ++i)
          parser->parser.DefineVar(names[i], &parser->variables[i]);
        parser->parser.DefineConst("pi", numbers::PI);
        parser->parser.SetExpr(text);
        parser->parser.Eval();
      }
    catch (const mu::ParserError &error)
      {
        throw SceneError("the expression '" + text +
                         "' cannot be evaluated: " + error.GetMsg() +
                         ". It may use x, y, z, X, Y, Z, t, pi and muParser's "
                         "functions.");
      }
  }

  Expression::~Expression()                      = default;
  Expression::Expression(Expression &&) noexcept = default;
  Expression &
  Expression::operator=(Expression &&) noexcept = default;

  template <int dim>
  double
  Expression::value(const Point<dim> &x,
                    const double      t,
                    const Point<dim> &X) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        parser->variables[d]     = x[d];
        parser->variables[3 + d] = X[d];
      }
    parser->variables[6] = t;
    return parser->parser.Eval();
  }

  const std::string &
  Expression::text() const
  {
    return parser->text;
  }

  template <int dim>
  VectorExpression<dim>::VectorExpression(const std::string &text)
  {
    const auto parts = Utilities::split_string_list(text, ';');
    if (parts.size() != dim)
      throw SceneError("the vector function '" + text + "' has " +
                       std::to_string(parts.size()) + " components; " +
                       std::to_string(dim) +
                       " are needed, separated by semicolons.");
    for (const auto &part : parts)
      components.emplace_back(part);
  }

  template <int dim>
  Tensor<1, dim>
  VectorExpression<dim>::value(const Point<dim> &x,
                               const double      t,
                               const Point<dim> &X) const
  {
    Tensor<1, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = components[d].value(x, t, X);
    return result;
  }

  template double
  Expression::value<2>(const Point<2> &, const double, const Point<2> &) const;
  template double
  Expression::value<3>(const Point<3> &, const double, const Point<3> &) const;
  template class VectorExpression<2>;
  template class VectorExpression<3>;
} // namespace selkie
