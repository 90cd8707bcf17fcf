#pragma once

#include <selkie/particles/particle_set.h>
#include <selkie/shape/support_table.h>

namespace selkie
{
  /**
   * Starts a support table: one patch of material points per cell and phase,
   * with the points' state at t_n, in an order that does not depend on the
   * partition. The patches' nodes and shape functions are left to the
   * approximation.
   */
  template <int dim>
  void
  gather_points(const ParticleSet<dim> &particles, SupportTable<dim> &table);
} // namespace selkie
