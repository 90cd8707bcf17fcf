#pragma once

#include <selkie/scene/scene.h>

#include <deal.II/base/mpi.h>

namespace selkie
{
  /// Runs a scene to its end time. Collective.
  /// @return the exit code of the program
  template <int dim>
  int
  run_scene(const Scene<dim> &scene, const MPI_Comm comm);

  /// What `selkie check` prints: effects, unknowns, memory and time forecast.
  /// Collective; rank 0 prints.
  template <int dim>
  void
  print_plan(const Scene<dim> &scene, const MPI_Comm comm);
} // namespace selkie
