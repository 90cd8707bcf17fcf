#pragma once

#include <selkie/particles/particle_set.h>
#include <selkie/particles/seed.h>

#include <deal.II/base/array_view.h>

namespace selkie
{
  /// Gives a new point mass, velocity and the undeformed state, or that of its
  /// body's initial pressure, in those columns that exist.
  /// @param properties of the point; all are written
  /// @throw SceneError for a pressure that the body's law does not reach
  template <int dim>
  void
  set_first_state(const Scene<dim>                &scene,
                  const ParticleColumns<dim>      &columns,
                  const Seed<dim>                 &seed,
                  const dealii::ArrayView<double> &properties);
} // namespace selkie
