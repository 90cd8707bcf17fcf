#pragma once

#include <selkie/scene/shapes.h>

#include <deal.II/base/point.h>

#include <memory>
#include <string>
#include <vector>

/**
 * @file
 * The primitives of which make_shape() builds a shape. Each throws SceneError
 * for a region without volume.
 */
namespace selkie
{
  /// The box between two corners.
  template <int dim>
  std::shared_ptr<const Shape<dim>>
  make_box(const dealii::Point<dim> &lower, const dealii::Point<dim> &upper);

  /// Disc in 2D, ball in 3D.
  template <int dim>
  std::shared_ptr<const Shape<dim>>
  make_ball(const dealii::Point<dim> &centre, const double radius);

  /// The polygon with these corners, in either sense; 2D only. Its sides must
  /// not cross.
  std::shared_ptr<const Shape<2>>
  make_polygon(const std::vector<dealii::Point<2>> &corners);

  /// The points of a box where an expression of x, y, z is positive.
  template <int dim>
  std::shared_ptr<const Shape<dim>>
  make_inside(const dealii::Point<dim> &lower,
              const dealii::Point<dim> &upper,
              const std::string        &expression);

  using dealii::BoundingBox;

  /// The common part of two boxes; false if it has no volume.
  template <int dim>
  bool
  overlap(const BoundingBox<dim> &a,
          const BoundingBox<dim> &b,
          BoundingBox<dim>       &common);

  /// Whether x and the points at a distance `step` (m) from it along the axes
  /// are inside: x is not on the boundary.
  template <int dim>
  bool
  well_inside(const Shape<dim>         &shape,
              const dealii::Point<dim> &x,
              const double              step);

  /// Calls visit(x) for the centres of 1000^2 or 100^3 equal cells of a box.
  template <int dim, typename Visit>
  void
  sample(const BoundingBox<dim> &box, const Visit &visit)
  {
    constexpr unsigned int n = (dim == 2 ? 1000 : 100);
    dealii::Point<dim>     x;
    for (unsigned int k = 0; k < (dim == 3 ? n : 1); ++k)
      for (unsigned int j = 0; j < n; ++j)
        for (unsigned int i = 0; i < n; ++i)
          {
            const unsigned int index[3] = {i, j, k};
            for (unsigned int d = 0; d < dim; ++d)
              x[d] =
                box.lower_bound(d) + (index[d] + 0.5) / n * box.side_length(d);
            visit(x);
          }
  }

  /// How many points sample() visits.
  template <int dim>
  constexpr double n_samples = 1e6;
} // namespace selkie
