#pragma once

#include <selkie/particles/particle_set.h>

namespace selkie
{
  /// Volume ratio of a point: J of a fluid, det F of a solid.
  template <int dim>
  double
  volume_ratio(const ParticleSet<dim>                &particles,
               const dealii::ArrayView<const double> &properties);
} // namespace selkie
