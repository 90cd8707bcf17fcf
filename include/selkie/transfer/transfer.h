#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/assembly/system.h>
#include <selkie/base/types.h>
#include <selkie/particles/particle_set.h>
#include <selkie/shape/support_table.h>
#include <selkie/time/newmark.h>
#include <selkie/transfer/nodal_state.h>

namespace selkie
{
  /**
   * Points to nodes: lumped mass M_a = sum m N_a and the lumped recovery of
   * velocity and acceleration, v_a = sum m N_a v_p / M_a (with TPIC
   * v_p + grad v_p (x_a - x_p)). Prescribed entries take the prescribed
   * velocity. Pressures start from the stored nodal pressure, or, where the
   * node had none, from the points' mean.
   *
   * @param stored_pressure of the last step, cloud numbering; NaN where none.
   * @param nodes of a Lagrangian mesh, whose velocities and accelerations are
   *        not recovered but kept; else nullptr.
   * @param fields is initialised here on the system's numbering, ghosts
   *        included; fields.x holds zero increments and the pressures.
   */
  template <int dim>
  void
  project(const ParticleSet<dim>  &particles,
          const SupportTable<dim> &table,
          const System<dim>       &system,
          const double             t_n,
          const double             dt,
          const Vector            &stored_pressure,
          const NodalState<dim>   *nodes,
          StepFields              &fields);

  /// Nodal pressures of the iterate in cloud numbering, NaN where none, with
  /// ghosts.
  template <int dim>
  void
  store_pressure(const System<dim> &system,
                 const StepFields  &fields,
                 Vector            &stored_pressure);

  /// What correct_volume() found and did.
  struct VolumeCorrection
  {
    double excess = 0; ///< mean of theta - 1 inside the fluid, smoothed in time
    double energy = 0; ///< given to the fluid by it (J), on this rank
  };

  /**
   * Volume drift: points that crowd get a smaller J_n, so that the fluid
   * expands again (formulation.md 4, quadrature.md 4). In a step
   *   J_n *= 1 - rate dt (crowd - mean crowd + excess / 4),
   *   crowd = min(0.2, max(0, theta - 1 - deadband)).
   * theta is the volume of the points over that of the space: both are weighted
   * with the cells' hat functions, whose integrals are known on any mesh, and
   * theta is interpolated with them. Its scatter would make the fluid swell, as
   * only the upper side counts; so the local part is there to move volume, and
   * the drift of the whole is corrected both ways by the mean of theta - 1 over
   * the nodes deep inside the fluid, smoothed over the time 2 / rate lest the
   * pressure jumps. Collective.
   * @param last_excess that of the last step
   */
  template <int dim>
  VolumeCorrection
  correct_volume(const FluidPressure &parameters,
                 const double         dt,
                 const double         last_excess,
                 const System<dim>   &system,
                 SupportTable<dim>   &table);

  /// Interpolates nodal accelerations to the points: the start of a run.
  template <int dim>
  void
  set_accelerations(ParticleSet<dim>        &particles,
                    const SupportTable<dim> &table,
                    const System<dim>       &system,
                    const Vector            &a);

  /// What the update of the points did that the equations do not know of.
  struct AdvanceReport
  {
    double reset_energy = 0; ///< compression energy added by the J reset (J)
  };

  /**
   * Nodes to points, the only writer of point data: positions, velocities
   * (FLIP or TPIC; interpolated with a Lagrangian mesh), accelerations,
   * deformation gradients, and the reset of fluid points' J from the nodal
   * pressure.
   * @return report, summed over the ranks.
   */
  template <int dim>
  AdvanceReport
  advance(ParticleSet<dim>        &particles,
          const SupportTable<dim> &table,
          const System<dim>       &system,
          const Newmark           &newmark,
          const StepFields        &fields);
} // namespace selkie
