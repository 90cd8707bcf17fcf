#pragma once

#include <selkie/adapt/occupied_cell.h>

namespace selkie
{
  /// The criteria of the solids' strain: its size, its variation in a cell, and
  /// what the cell misses of the strain that its neighbours agree on. The last
  /// two say how often a cell should be halved or joined.
  /// @param cells those that hold points, in the order of the points; gets
  ///   excess and level. Collective.
  template <int dim>
  void
  limit_strain(const ParticleSet<dim>         &particles,
               const NodeCloud<dim>           &cloud,
               std::vector<OccupiedCell<dim>> &cells);
} // namespace selkie
