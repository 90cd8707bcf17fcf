#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/assembly/system.h>
#include <selkie/base/types.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/scene/scene.h>
#include <selkie/shape/q4_support.h>

#include <array>

namespace selkie
{
  /// What the nodes of a Lagrangian mesh keep from step to step, in cloud
  /// numbering, with ghosts; zero at nodes without unknowns, but for hanging
  /// ones, which go with their masters.
  template <int dim>
  struct NodalState
  {
    std::array<Vector, dim> displacement; ///< m
    std::array<Vector, dim> velocity;     ///< m/s
    std::array<Vector, dim> acceleration; ///< m/s^2

    /// @param q4 of the same cloud; it must stay.
    NodalState(const NodeCloud<dim> &cloud, const Q4Support<dim> &q4);

    /// The initial velocities of the bodies, at their nodes; the mean of all
    /// bodies' at a common one. Collective.
    void
    start(const Scene<dim>        &scene,
          const NodeCloud<dim>    &cloud,
          const SupportTable<dim> &table);

    /// Velocity and acceleration at t_n to the system's numbering (owned
    /// entries; prescribed ones too).
    void
    recall(const System<dim> &system, StepFields &fields) const;

    /// @p a on the system's numbering: the start of a run.
    void
    set_acceleration(const System<dim> &system, const Vector &a);

    /// The nodes at t_{n+1}, after a converged step.
    void
    keep(const System<dim> &system,
         const Newmark     &newmark,
         const StepFields  &fields);

  private:
    /// Hanging nodes and ghosts follow. Collective.
    void
    complete();

    const Q4Support<dim> &q4;
  };
} // namespace selkie
