#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/output/recorder.h>
#include <selkie/solver/newton.h>

namespace selkie
{
  /// What one step did.
  template <int dim>
  struct StepReport
  {
    NewtonResult       newton;
    double             lambda_iterations     = 0; ///< mean over the points
    unsigned int       max_lambda_iterations = 0;
    unsigned long long unknowns = 0, patches = 0;
    double             dissipated    = 0; ///< heat (J)
    double             external_work = 0; ///< loads and moving walls (J)
    double             reset_energy  = 0; ///< by the J reset (J)
    double             volume_energy = 0; ///< by the volume correction (J)
    double             crowding      = 0; ///< VolumeCorrection::excess
    double             time_error    = 0; ///< of the step, rms (m), on request
    double             moved         = 0; ///< in the step, rms (m), with it
    double             largest_speed = 0; ///< of the nodes (m/s)
    WallForces<dim>    walls;             ///< of the matter on them

    // For the audit:
    double kinetic            = 0; ///< energy of the nodes (J)
    double smallest_node_mass = 0; ///< kg
    double checkerboard       = 0; ///< of the pressure: alternating share
  };

  /// What the matter does to the walls: the residual that their nodes keep;
  /// and the work that prescribed motions put in with it.
  template <int dim>
  void
  collect_reactions(const System<dim> &system,
                    const Vector      &residual,
                    const StepFields  &fields,
                    StepReport<dim>   &report);

  /// The largest speed of the nodes. Collective.
  template <int dim>
  double
  largest_speed(const System<dim> &system,
                const StepFields  &fields,
                const Newmark     &newmark);

  /// For the audit: kinetic energy and smallest mass of the nodes, with
  /// inertia. Collective.
  template <int dim>
  void
  collect_motion(const System<dim> &system,
                 const StepFields  &fields,
                 const Newmark     &newmark,
                 StepReport<dim>   &report);

  /**
   * Newmark's local error in the displacement, dt^2 |beta - 1/6| |a - a_n|
   * (Zienkiewicz & Xie 1991), and the first order part dt^2 |gamma - 1/2| of a
   * damped scheme; weighted with the nodes' masses. Collective.
   */
  template <int dim>
  void
  estimate_time_error(const System<dim> &system,
                      const StepFields  &fields,
                      const Newmark     &newmark,
                      const Inertia     &inertia,
                      StepReport<dim>   &report);

  /**
   * How much of the nodes' pressure alternates from node to node: rms over the
   * cells whose corners all have a pressure (of one phase) of the part that
   * changes its sign along every edge, over the rms of the pressure there. 0
   * without such cells. Collective.
   */
  template <int dim>
  double
  checkerboard(const System<dim>       &system,
               const SupportTable<dim> &table,
               const StepFields        &fields);
} // namespace selkie
