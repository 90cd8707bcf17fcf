#pragma once

#include <selkie/particles/particle_set.h>

namespace selkie
{
  /**
   * The hydrostatic start: the points of each body that asks for it get the
   * pressure rho_0 |g| d at their depth d below the body's highest point (along
   * gravity), and the J that belongs to it; no displacement. Local.
   */
  template <int dim>
  void
  set_hydrostatic_state(ParticleSet<dim> &particles);
} // namespace selkie
