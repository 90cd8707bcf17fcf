#include <selkie/base/exceptions.h>
#include <selkie/base/expression.h>
#include <selkie/scene/primitives.h>

#include <deal.II/base/numbers.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Points this close to a boundary, relative to the size of the primitive,
    /// count as inside: coordinates carry round-off.
    constexpr double round_off = 1e-12;

    template <int dim>
    double
    size(const Point<dim> &lower, const Point<dim> &upper)
    {
      return std::max({lower.norm(), upper.norm(), lower.distance(upper)});
    }


    template <int dim>
    BoundingBox<dim>
    checked_box(const Point<dim> &lower, const Point<dim> &upper)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (!(lower[d] < upper[d]))
          throw SceneError("its lower corner must be below and left of its "
                           "upper corner; it has no volume");
      return BoundingBox<dim>({lower, upper});
    }


    template <int dim>
    class Box : public Shape<dim>
    {
    public:
      Box(const Point<dim> &lower, const Point<dim> &upper)
        : box(checked_box(lower, upper))
        , tolerance(round_off * size(lower, upper))
      {}

      bool
      contains(const Point<dim> &x) const override
      {
        for (unsigned int d = 0; d < dim; ++d)
          if (x[d] < box.lower_bound(d) - tolerance ||
              x[d] > box.upper_bound(d) + tolerance)
            return false;
        return true;
      }

      BoundingBox<dim>
      bounding_box() const override
      {
        return box;
      }

      double
      volume() const override
      {
        return box.volume();
      }

    private:
      const BoundingBox<dim> box;
      const double           tolerance;
    };


    template <int dim>
    class Ball : public Shape<dim>
    {
    public:
      Ball(const Point<dim> &centre, const double radius)
        : centre(centre)
        , radius(radius)
        , tolerance(round_off * (centre.norm() + radius))
      {
        if (!(radius > 0))
          throw SceneError("its radius must be positive");
      }

      bool
      contains(const Point<dim> &x) const override
      {
        return x.distance(centre) <= radius + tolerance;
      }

      BoundingBox<dim>
      bounding_box() const override
      {
        Point<dim> lower = centre, upper = centre;
        for (unsigned int d = 0; d < dim; ++d)
          {
            lower[d] -= radius;
            upper[d] += radius;
          }
        return BoundingBox<dim>({lower, upper});
      }

      double
      volume() const override
      {
        return (dim == 2 ? 1. : 4. / 3. * radius) * numbers::PI * radius *
               radius;
      }

    private:
      const Point<dim> centre;
      const double     radius;
      const double     tolerance;
    };


    /// Twice the signed area of the triangle (a, b, c).
    double
    cross(const Point<2> &a, const Point<2> &b, const Point<2> &c)
    {
      return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    }


    class Polygon : public Shape<2>
    {
    public:
      Polygon(const std::vector<Point<2>> &corners)
        : corners(corners)
        , box(BoundingBox<2>(corners))
        , tolerance(round_off * size<2>(box.get_boundary_points().first,
                                        box.get_boundary_points().second))
      {
        if (sides_cross())
          throw SceneError("its sides cross");
        if (!(volume() > 0))
          throw SceneError("it has no area");
      }

      bool
      contains(const Point<2> &x) const override
      {
        bool               inside = false;
        const unsigned int n      = corners.size();
        for (unsigned int i = 0; i < n; ++i)
          {
            const Point<2> &a = corners[i];
            const Point<2> &b = corners[(i + 1) % n];
            if (distance_to_side(x, a, b) <= tolerance)
              return true;
            if ((a[1] > x[1]) != (b[1] > x[1]) &&
                x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
              inside = !inside;
          }
        return inside;
      }

      BoundingBox<2>
      bounding_box() const override
      {
        return box;
      }

      double
      volume() const override
      {
        double twice = 0;
        for (unsigned int i = 2; i < corners.size(); ++i)
          twice += cross(corners[0], corners[i - 1], corners[i]);
        return std::abs(twice) / 2;
      }

    private:
      static double
      distance_to_side(const Point<2> &x, const Point<2> &a, const Point<2> &b)
      {
        const double length2 = (b - a).norm_square();
        const double s =
          length2 > 0 ? std::clamp((x - a) * (b - a) / length2, 0., 1.) : 0.;
        return x.distance(a + s * (b - a));
      }

      bool
      sides_cross() const
      {
        const unsigned int n = corners.size();
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = i + 2; j < n; ++j)
            {
              const Point<2> &a = corners[i], &b = corners[(i + 1) % n];
              const Point<2> &c = corners[j], &d = corners[(j + 1) % n];
              if ((j + 1) % n != i && cross(a, b, c) * cross(a, b, d) < 0 &&
                  cross(c, d, a) * cross(c, d, b) < 0)
                return true;
            }
        return false;
      }

      const std::vector<Point<2>> corners;
      const BoundingBox<2>        box;
      const double                tolerance;
    };


    template <int dim>
    class Inside : public Shape<dim>
    {
    public:
      Inside(const Point<dim>  &lower,
             const Point<dim>  &upper,
             const std::string &text)
        : box(lower, upper)
        , expression(text)
      {}

      bool
      contains(const Point<dim> &x) const override
      {
        return box.contains(x) && expression.value<dim>(x, 0., x) > 0;
      }

      BoundingBox<dim>
      bounding_box() const override
      {
        return box.bounding_box();
      }

      /// By sampling.
      double
      volume() const override
      {
        unsigned int n = 0;
        sample(box.bounding_box(), [&](const Point<dim> &x) {
          n += (expression.value<dim>(x, 0., x) > 0);
        });
        return n / n_samples<dim> * box.volume();
      }

    private:
      const Box<dim>   box;
      const Expression expression;
    };
  } // namespace


  template <int dim>
  bool
  overlap(const BoundingBox<dim> &a,
          const BoundingBox<dim> &b,
          BoundingBox<dim>       &common)
  {
    Point<dim> lower, upper;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = std::max(a.lower_bound(d), b.lower_bound(d));
        upper[d] = std::min(a.upper_bound(d), b.upper_bound(d));
        if (upper[d] - lower[d] <=
            round_off * std::max(a.side_length(d), b.side_length(d)))
          return false;
      }
    common = BoundingBox<dim>({lower, upper});
    return true;
  }


  template <int dim>
  bool
  well_inside(const Shape<dim> &shape, const Point<dim> &x, const double step)
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        Tensor<1, dim> move;
        move[d] = step;
        if (!shape.contains(x + move) || !shape.contains(x - move))
          return false;
      }
    return shape.contains(x);
  }


  template <int dim>
  std::shared_ptr<const Shape<dim>>
  make_box(const Point<dim> &lower, const Point<dim> &upper)
  {
    return std::make_shared<const Box<dim>>(lower, upper);
  }


  template <int dim>
  std::shared_ptr<const Shape<dim>>
  make_ball(const Point<dim> &centre, const double radius)
  {
    return std::make_shared<const Ball<dim>>(centre, radius);
  }


  std::shared_ptr<const Shape<2>>
  make_polygon(const std::vector<Point<2>> &corners)
  {
    return std::make_shared<const Polygon>(corners);
  }


  template <int dim>
  std::shared_ptr<const Shape<dim>>
  make_inside(const Point<dim>  &lower,
              const Point<dim>  &upper,
              const std::string &expression)
  {
    return std::make_shared<const Inside<dim>>(lower, upper, expression);
  }


  template bool
  overlap(const BoundingBox<2> &, const BoundingBox<2> &, BoundingBox<2> &);
  template bool
  overlap(const BoundingBox<3> &, const BoundingBox<3> &, BoundingBox<3> &);
  template bool
  well_inside(const Shape<2> &, const Point<2> &, const double);
  template bool
  well_inside(const Shape<3> &, const Point<3> &, const double);
  template std::shared_ptr<const Shape<2>>
  make_box(const Point<2> &, const Point<2> &);
  template std::shared_ptr<const Shape<3>>
  make_box(const Point<3> &, const Point<3> &);
  template std::shared_ptr<const Shape<2>>
  make_ball(const Point<2> &, const double);
  template std::shared_ptr<const Shape<3>>
  make_ball(const Point<3> &, const double);
  template std::shared_ptr<const Shape<2>>
  make_inside(const Point<2> &, const Point<2> &, const std::string &);
  template std::shared_ptr<const Shape<3>>
  make_inside(const Point<3> &, const Point<3> &, const std::string &);
} // namespace selkie
