#pragma once

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/point.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

namespace selkie
{
  /**
   * A closed region of space: what a body, an obstacle or a named set of
   * nodes covers. Immutable; shared by copies of the scene.
   */
  template <int dim>
  class Shape
  {
  public:
    virtual ~Shape() = default;

    /// Whether x (m) lies inside, the boundary included to round-off.
    virtual bool
    contains(const dealii::Point<dim> &x) const = 0;

    virtual dealii::BoundingBox<dim>
    bounding_box() const = 0;

    /// Volume (m^3; area in 2D, m^2): exact for the primitives and for
    /// disjoint unions and contained differences of them, otherwise by fine
    /// sampling.
    virtual double
    volume() const = 0;
  };

  /// The smallest value of g.x in a box: of its highest point, g being gravity.
  template <int dim>
  double
  top_level(const dealii::BoundingBox<dim> &box,
            const dealii::Tensor<1, dim>   &g)
  {
    double level = std::numeric_limits<double>::max();
    for (unsigned int v = 0; v < (1u << dim); ++v)
      level = std::min(level, g * dealii::Tensor<1, dim>(box.vertex(v)));
    return level;
  }

  /**
   * Reads a shape from its text, e.g. `box(0, 0, 0.146, 0.292)`,
   * `disc(0.5, 0.5, 0.2)`, `sphere(x, y, z, r)`, `polygon(x0, y0, x1, y1, …)`,
   * `inside(x0, y0, x1, y1, expression)` (points of the box where the
   * expression of x, y, z is positive), joined by `+` (union) and `-`
   * (difference), evaluated from left to right, with parentheses.
   * Throws SceneError with the text and what is wrong.
   */
  template <int dim>
  std::shared_ptr<const Shape<dim>>
  make_shape(const std::string &text);
} // namespace selkie
