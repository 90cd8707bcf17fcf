#pragma once

#include <selkie/scene/scene.h>

#include <deal.II/base/mpi.h>

namespace selkie
{
  /// Runs a scene to its end time. Collective.
  /// @return the exit code of the program: 0, or 2 after a numerical failure
  ///   that no smaller step cured (a checkpoint is written).
  template <int dim>
  int
  run_scene(const Scene<dim> &scene, const MPI_Comm comm);

  /// What `selkie check` prints: effects, terms, columns, unknowns, memory and
  /// a forecast of the time, measured on one step of which nothing is kept.
  /// Collective; rank 0 prints.
  template <int dim>
  void
  print_plan(const Scene<dim> &scene, const MPI_Comm comm);
} // namespace selkie
