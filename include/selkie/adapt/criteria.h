#pragma once

#include <selkie/adapt/wanted_levels.h>
#include <selkie/base/types.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>

#include <array>
#include <vector>

namespace selkie
{
  /// What the nodes know, in cloud numbering with ghosts; null where they know
  /// nothing (yet).
  template <int dim>
  struct NodalView
  {
    const std::array<Vector, dim> *velocity = nullptr; ///< m/s
    const Vector                  *mass     = nullptr; ///< zero: not in use
    const Vector                  *pressure = nullptr; ///< Pa
  };

  /**
   * Where the scene's criteria want cells of which level, as boxes around this
   * rank's cells, the buffer included (effect `adaptivity`). What is the finest
   * already stays so down to half of a limit. Collective.
   */
  template <int dim>
  std::vector<typename WantedLevels<dim>::Part>
  wanted_parts(const ParticleSet<dim> &particles,
               const NodeCloud<dim>   &cloud,
               const NodalView<dim>   &nodes);

  /// Spacing of the finest cells that a scene allows (m).
  template <int dim>
  double
  finest_spacing(const Domain<dim> &domain, const Adaptivity &wishes);
} // namespace selkie
