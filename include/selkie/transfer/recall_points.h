#pragma once

#include <selkie/particles/particle_set.h>
#include <selkie/transfer/carried_fields.h>

namespace selkie
{
  /**
   * Gives the Gauss points of a Lagrangian mesh, as they were seeded, the state
   * that the nodes' fields have there (names: Stepper::kept_fields()): place,
   * F, velocity and acceleration; with a pressure the volume ratio, too. This
   * is all that a point carries: a law with a history would need more.
   */
  template <int dim>
  void
  recall_points(ParticleSet<dim> &particles, const CarriedFields<dim> &fields);
} // namespace selkie
