#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/solver/linear_solver.h>

#include <functional>
#include <string>

namespace selkie
{
  /**
   * The acceleration that balances the forces at the start: M a = -residual in
   * the free displacements, with the mass of the scene. The consistent mass of
   * fewer points than nodes is singular, and such a body starts with the lumped
   * one. With ghosts. Collective.
   * @param unknowns their matrix is overwritten
   * @param log takes a line if the lumped mass stands in
   */
  template <int dim>
  Vector
  start_acceleration(const Scene<dim>                               &scene,
                     const typename Assembler<dim>::Terms           &terms,
                     const SupportTable<dim>                        &table,
                     const StepTime                                 &time,
                     StepFields                                     &fields,
                     const Vector                                   &residual,
                     System<dim>                                    &unknowns,
                     LinearSolver<dim>                              &solver,
                     const std::function<void(const std::string &)> &log);
} // namespace selkie
