#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>

#include <algorithm>
#include <vector>

namespace selkie
{
  /// A cell that holds points: the largest share of a limit that it takes up,
  /// of the criteria that want the finest cells (from 1 on they do), and the
  /// level that its error asks for (0: none).
  template <int dim>
  struct OccupiedCell
  {
    typename NodeCloud<dim>::Cell cell;
    double                        excess = 0;
    unsigned int                  level  = 0;
  };

  /// Raises the excess of cells whose figure (one for each cell) takes up more
  /// of what a criterion allows at most; none if that is 0.
  template <int dim>
  void
  limit(std::vector<OccupiedCell<dim>> &cells,
        const std::vector<double>      &figures,
        const double                    most)
  {
    if (most <= 0.)
      return;
    for (unsigned int i = 0; i < cells.size(); ++i)
      cells[i].excess = std::max(cells[i].excess, figures[i] / most);
  }

  /// Calls action(i, point) for every point, i being its cell's place.
  template <int dim, typename Action>
  void
  for_each_point(const ParticleSet<dim>               &particles,
                 const std::vector<OccupiedCell<dim>> &cells,
                 const Action                         &action)
  {
    unsigned int i = 0;
    for (const auto &point : particles.handler())
      {
        if (typename NodeCloud<dim>::Cell(point.get_surrounding_cell()) !=
            cells[i].cell)
          ++i;
        action(i, point);
      }
  }
} // namespace selkie
