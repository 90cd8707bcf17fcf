#pragma once

#include <selkie/scene/scene.h>

#include <deal.II/base/mpi.h>

namespace selkie
{
  /// Runs a scene to its end time, from the start or, `resumed`, from the last
  /// checkpoint in its output folder. Collective.
  /// @return the exit code of the program: 0, or 2 after a numerical failure
  ///   that no smaller step cured (a checkpoint is written).
  template <int dim>
  int
  run_scene(const Scene<dim> &scene,
            const MPI_Comm    comm,
            const bool        resumed = false);

  /// What `selkie check` prints: effects, terms, columns, unknowns, memory and
  /// a forecast of the time, measured on the first steps, of which nothing is
  /// kept. Collective; rank 0 prints.
  template <int dim>
  void
  print_plan(const Scene<dim> &scene, const MPI_Comm comm);
} // namespace selkie
