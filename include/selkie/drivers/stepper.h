#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/assembly/node_release.h>
#include <selkie/base/timer_tree.h>
#include <selkie/drivers/kept_numbers.h>
#include <selkie/drivers/residual_scales.h>
#include <selkie/drivers/step_report.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>
#include <selkie/shape/lme_support.h>
#include <selkie/shape/q4_support.h>
#include <selkie/solver/linear_solver.h>
#include <selkie/terms/effect_table.h>
#include <selkie/transfer/carried_fields.h>
#include <selkie/transfer/nodal_state.h>
#include <selkie/transfer/recovery_error.h>
#include <selkie/transfer/transfer.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace selkie
{
  /**
   * One step (design.md, section 2): supports, projection, Newton on
   * displacement increments and pressures, update of the points. Until the
   * step has converged nothing but scratch is written, so a failed step is
   * undone by not using it.
   */
  template <int dim>
  class Stepper
  {
  public:
    /// @param log takes one line for each fall-back
    Stepper(const Scene<dim>                        &scene,
            ParticleSet<dim>                        &particles,
            const NodeCloud<dim>                    &cloud,
            TimerTree                               &timers,
            std::function<void(const std::string &)> log);

    /// The same run on a new mesh: @p costs are those of before.
    void
    go_on_from(const CarriedFields<dim> &fields,
               const KeptNumbers        &numbers,
               const CostLedger         &costs);

    /// Gives the points the acceleration that balances the forces at t = 0.
    void
    start(const double t, const double dt);

    /// Advances the points from t to t + dt. Throws NumericalFailure, with the
    /// points untouched.
    StepReport<dim>
    step(const double t, const double dt);

    /// Velocity and mass (with inertia) and pressure (the fluid's where several
    /// phases meet) of the nodes at the end of the last step, in cloud
    /// numbering; zero at nodes without unknowns, empty where there are none.
    struct NodalFields
    {
      std::array<Vector, dim> displacement; ///< of a Lagrangian mesh
      std::array<Vector, dim> velocity;
      Vector                  mass, pressure;
    };
    NodalFields
    nodal_fields(const double dt) const;

    /// The names of the active terms.
    std::vector<std::string>
    term_names() const;

    /// Of a Lagrangian mesh, else nullptr.
    const NodalState<dim> *
    nodal_state() const
    {
      return nodes.get();
    }

    /// The fluid's pressure at its nodes, at the end of the last step (Pa; NaN
    /// at others), or nullptr.
    const Vector *
    fluid_pressure() const
    {
      return scene.has_fluid() ? &stored_pressures.at(0) : nullptr;
    }

    /// What the nodes keep from step to step, by name, numbered as the node
    /// cloud is: it belongs in a checkpoint.
    std::map<std::string, const Vector *>
    kept_fields() const;

    /// Goes on from kept_fields() and kept_numbers() of an earlier run.
    void
    restore(const CarriedFields<dim> &fields, const KeptNumbers &numbers);

    /// The mesh fits the matter as it is now: kept_numbers().moved is zero.
    void
    mesh_fits()
    {
      kept.moved = 0.;
    }

    const KeptNumbers &
    kept_numbers() const
    {
      return kept;
    }

    const System<dim> &
    system() const
    {
      return unknowns;
    }

    const SupportTable<dim> &
    supports() const
    {
      return table;
    }

    /// What the terms and the rest of the assembly cost so far, on this rank.
    const CostLedger &
    costs() const
    {
      return assembler.costs();
    }

    /// What the mesh could not resolve in the last step, of size dt.
    RecoveryError
    spatial_error(const double dt) const
    {
      return recovery_error(table, unknowns, newmark(dt), fields);
    }

    /// The solver that the last system used, and why it was chosen.
    std::string
    solver_in_use(const double dt) const;

  private:
    void
    build_supports(const double t, const double dt);
    void
    together(const std::function<void()> &action) const;
    void
    fill_supports();
    bool
    has_full_cells() const;
    NewtonProblem
    newton_problem(const StepTime &time);
    SystemTraits
    traits(const Newmark &newmark) const;
    void
    prepare_conditions(const double t);
    NewtonResult
    solve(const StepTime &time, Vector &residual);
    void
    set_predictor(const Newmark &newmark);
    void
    choose_first_guess(const StepTime &time);
    double
    acceleration_scale() const;
    double
    unbalanced_work() const;
    void
    collect(const StepTime &time, const Vector &residual, StepReport<dim> &);
    Newmark
    newmark(const double dt) const;

    const Scene<dim>                                   &scene;
    ParticleSet<dim>                                   &particles;
    const NodeCloud<dim>                               &cloud;
    TimerTree                                          &timers;
    const std::function<void(const std::string &)>      log;
    NodeConditions<dim>                                 conditions;
    const std::vector<std::shared_ptr<const Term<dim>>> terms;

    System<dim>                           unknowns;
    Assembler<dim>                        assembler;
    LinearSolver<dim>                     linear_solver;
    SupportTable<dim>                     table;
    StepFields                            fields;
    Occupancy<dim>                        occupancy;
    GaussSupports<dim>                    gauss_supports;
    std::unique_ptr<NodeRelease<dim>>     release; ///< on request
    std::unique_ptr<const Q4Support<dim>> q4;      ///< hat functions
    std::unique_ptr<NodalState<dim>>      nodes;   ///< of a Lagrangian mesh
    StoredPressures                       stored_pressures;
    VolumeCorrection                      volume; ///< of the present step
    KeptNumbers                           kept;   ///< of the last good step
    ResidualScales                        scales; ///< of the present step
  };
} // namespace selkie
