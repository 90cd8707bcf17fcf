#include <selkie/base/exceptions.h>
#include <selkie/base/expression.h>
#include <selkie/scene/primitives.h>
#include <selkie/scene/shapes.h>

#include <cctype>
#include <cmath>
#include <limits>
#include <vector>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Volume of the common part of two shapes. Exact when they are disjoint,
    /// when one lies inside the other, or when both fill the common part of
    /// their bounding boxes, as far as 10^6 samples tell; otherwise the share
    /// of the samples that both contain.
    template <int dim>
    double
    common_volume(const Shape<dim> &a, const Shape<dim> &b)
    {
      const auto       a_box = a.bounding_box(), b_box = b.bounding_box();
      BoundingBox<dim> common;
      if (!overlap(a_box, b_box, common))
        return 0.;
      double in_both = 0, in_a = 0, in_b = 0;
      sample(common, [&](const Point<dim> &x) {
        const bool a_holds = a.contains(x), b_holds = b.contains(x);
        in_a += a_holds;
        in_b += b_holds;
        in_both += (a_holds && b_holds);
      });
      const auto fills = [&](const BoundingBox<dim> &box) {
        return std::abs(box.volume() - common.volume()) <=
               1e-12 * common.volume();
      };
      if (in_both == 0)
        return 0.;
      if (in_both == n_samples<dim>)
        return common.volume();
      if (in_both == in_b && fills(b_box))
        return b.volume();
      if (in_both == in_a && fills(a_box))
        return a.volume();
      return in_both / n_samples<dim> * common.volume();
    }


    template <int dim>
    using ShapePointer = std::shared_ptr<const Shape<dim>>;


    template <int dim>
    class Union : public Shape<dim>
    {
    public:
      Union(ShapePointer<dim> a, ShapePointer<dim> b)
        : a(std::move(a))
        , b(std::move(b))
      {}

      bool
      contains(const Point<dim> &x) const override
      {
        return a->contains(x) || b->contains(x);
      }

      BoundingBox<dim>
      bounding_box() const override
      {
        BoundingBox<dim> box = a->bounding_box();
        box.merge_with(b->bounding_box());
        return box;
      }

      double
      volume() const override
      {
        return a->volume() + b->volume() - common_volume(*a, *b);
      }

    private:
      const ShapePointer<dim> a, b;
    };


    /// a without the interior of b. The boundary of b counts as inside, as
    /// that of a does: a point there is held by both a body and its hole.
    template <int dim>
    class Difference : public Shape<dim>
    {
    public:
      Difference(ShapePointer<dim> a, ShapePointer<dim> b)
        : a(std::move(a))
        , b(std::move(b))
        , step(1e-10 * (this->b->bounding_box().get_boundary_points().first -
                        this->b->bounding_box().get_boundary_points().second)
                         .norm())
      {}

      bool
      contains(const Point<dim> &x) const override
      {
        return a->contains(x) && !well_inside(*b, x, step);
      }

      BoundingBox<dim>
      bounding_box() const override
      {
        return a->bounding_box();
      }

      double
      volume() const override
      {
        return a->volume() - common_volume(*a, *b);
      }

    private:
      const ShapePointer<dim> a, b;
      const double            step;
    };


    /// Recursive descent: sum = term { (+|-) term }, term = ( sum ) | call,
    /// call = name ( arguments ).
    template <int dim>
    class ShapeParser
    {
    public:
      explicit ShapeParser(const std::string &text)
        : text(text)
      {}

      ShapePointer<dim>
      parse()
      {
        const ShapePointer<dim> shape = sum();
        if (position < text.size())
          fail("'" + text.substr(position) + "' is left over");
        return shape;
      }

    private:
      [[noreturn]] void
      fail(const std::string &why) const
      {
        throw SceneError("the shape '" + text + "' cannot be read: " + why +
                         ". Allowed are " + known() +
                         ", joined by + and -, with parentheses");
      }

      static std::string
      known()
      {
        return dim == 2 ? "box(x0, y0, x1, y1), disc(x, y, r), polygon(x0, "
                          "y0, x1, y1, ...), inside(x0, y0, x1, y1, expression)"
                        : "box(x0, y0, z0, x1, y1, z1), sphere(x, y, z, r), "
                          "inside(x0, y0, z0, x1, y1, z1, expression)";
      }

      void
      skip_blanks()
      {
        while (position < text.size() && std::isspace(text[position]))
          ++position;
      }

      /// Whether the next character is c; then it is consumed.
      bool
      next_is(const char c)
      {
        skip_blanks();
        if (position >= text.size() || text[position] != c)
          return false;
        ++position;
        skip_blanks();
        return true;
      }

      ShapePointer<dim>
      sum()
      {
        ShapePointer<dim> shape = term();
        while (true)
          if (next_is('+'))
            shape = std::make_shared<const Union<dim>>(shape, term());
          else if (next_is('-'))
            shape = std::make_shared<const Difference<dim>>(shape, term());
          else
            return shape;
      }

      ShapePointer<dim>
      term()
      {
        if (next_is('('))
          {
            const ShapePointer<dim> shape = sum();
            if (!next_is(')'))
              fail("a ')' is missing");
            return shape;
          }
        std::string name;
        while (position < text.size() && std::isalpha(text[position]))
          name += text[position++];
        if (!next_is('('))
          fail(name.empty() ? "the name of a shape is missing"
                            : "'" + name + "' must be followed by '('");
        const auto arguments = read_arguments();
        try
          {
            return primitive(name, arguments);
          }
        catch (const SceneError &error)
          {
            throw SceneError("the shape '" + text + "': " + name +
                             "(): " + error.what());
          }
      }

      /// The texts between the commas up to the closing parenthesis.
      std::vector<std::string>
      read_arguments()
      {
        std::vector<std::string> arguments(1);
        for (unsigned int depth = 1; position < text.size(); ++position)
          {
            const char c = text[position];
            depth += (c == '(');
            depth -= (c == ')');
            if (depth == 0)
              {
                ++position;
                skip_blanks();
                return arguments;
              }
            if (c == ',' && depth == 1)
              arguments.emplace_back();
            else if (!std::isspace(c) || !arguments.back().empty())
              arguments.back() += c;
          }
        fail("a ')' is missing");
      }

      /// The value of a constant such as `0.146` or `2*0.146`.
      static double
      number(const std::string &argument)
      {
        const double     nan = std::numeric_limits<double>::quiet_NaN();
        const Point<dim> nowhere =
          (dim == 2 ? Point<dim>(nan, nan) : Point<dim>(nan, nan, nan));
        const double value =
          Expression(argument).value<dim>(nowhere, nan, nowhere);
        if (!std::isfinite(value))
          throw SceneError("'" + argument + "' is not a number");
        return value;
      }

      static void
      expect(const std::vector<std::string> &arguments, const unsigned int n)
      {
        if (arguments.size() != n)
          throw SceneError("it needs " + std::to_string(n) +
                           " arguments and has " +
                           std::to_string(arguments.size()));
      }

      static Point<dim>
      point(const std::vector<std::string> &arguments, const unsigned int first)
      {
        Point<dim> p;
        for (unsigned int d = 0; d < dim; ++d)
          p[d] = number(arguments[first + d]);
        return p;
      }

      static ShapePointer<dim>
      primitive(const std::string              &name,
                const std::vector<std::string> &arguments)
      {
        if (name == "box")
          {
            expect(arguments, 2 * dim);
            return make_box(point(arguments, 0), point(arguments, dim));
          }
        if (name == (dim == 2 ? "disc" : "sphere"))
          {
            expect(arguments, dim + 1);
            return make_ball(point(arguments, 0), number(arguments[dim]));
          }
        if (name == "inside")
          return inside(arguments);
        if constexpr (dim == 2)
          if (name == "polygon")
            return polygon(arguments);
        throw SceneError("there is no such shape in " + std::to_string(dim) +
                         "D. Allowed are " + known());
      }

      static ShapePointer<dim>
      polygon(const std::vector<std::string> &arguments)
      {
        if (arguments.size() < 6 || arguments.size() % 2 != 0)
          throw SceneError("it needs the two coordinates of at least three "
                           "corners");
        std::vector<Point<dim>> corners;
        for (unsigned int i = 0; i < arguments.size(); i += 2)
          corners.push_back(point(arguments, i));
        return make_polygon(corners);
      }

      /// Commas in the expression belong to the expression.
      static ShapePointer<dim>
      inside(const std::vector<std::string> &arguments)
      {
        if (arguments.size() < 2 * dim + 1)
          throw SceneError("it needs " + std::to_string(2 * dim) +
                           " coordinates and an expression");
        std::string expression = arguments[2 * dim];
        for (unsigned int i = 2 * dim + 1; i < arguments.size(); ++i)
          expression += "," + arguments[i];
        return make_inside(point(arguments, 0),
                           point(arguments, dim),
                           expression);
      }

      const std::string text;
      std::size_t       position = 0;
    };
  } // namespace


  template <int dim>
  std::shared_ptr<const Shape<dim>>
  make_shape(const std::string &text)
  {
    return ShapeParser<dim>(text).parse();
  }


  template std::shared_ptr<const Shape<2>>
  make_shape(const std::string &);
  template std::shared_ptr<const Shape<3>>
  make_shape(const std::string &);
} // namespace selkie
