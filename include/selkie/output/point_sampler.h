#pragma once

#include <deal.II/base/point.h>
#include <deal.II/numerics/rtree.h>

#include <utility>
#include <vector>

namespace selkie
{
  /**
   * Values of scattered points at another place: the linear function that
   * fits those of the nearest points best, weighted with 1/distance^2. So a
   * linear field is met exactly, and at a point its own value.
   */
  template <int dim>
  class PointSampler
  {
  public:
    /// A point and its share in the value.
    using Stencil = std::vector<std::pair<std::size_t, double>>;

    /// @param points at least one (m)
    explicit PointSampler(const std::vector<dealii::Point<dim>> &points);

    /// The points that give the value at x, with shares that sum to one. The
    /// nearest point alone where those near x lie in a line (3D: plane).
    Stencil
    stencil(const dealii::Point<dim> &x) const;

    static constexpr unsigned int n_nearest = 2 * (dim + 1);

  private:
    using Entry = std::pair<dealii::Point<dim>, std::size_t>;

    dealii::RTree<Entry> tree;
  };
} // namespace selkie
