#pragma once

#include <selkie/adapt/adapt_mesh.h>
#include <selkie/base/log.h>
#include <selkie/base/timer_tree.h>
#include <selkie/drivers/forecast.h>
#include <selkie/drivers/run_audit.h>
#include <selkie/drivers/run_state.h>
#include <selkie/drivers/stepper.h>
#include <selkie/output/recorder.h>
#include <selkie/output/statistics.h>
#include <selkie/output/summary.h>
#include <selkie/output/vtu.h>
#include <selkie/time/time_control.h>

#include <memory>
#include <optional>
#include <string>

namespace selkie
{
  /// Times a call that returns something.
  template <typename Call>
  auto
  timed(TimerTree &timers, const std::string &name, const Call &call)
  {
    TimerTree::Scope scope(timers, name);
    return call();
  }

  /**
   * Everything that a run writes: folder, log, statistics, probes, VTU,
   * checkpoints, timings, summary. It reads the simulation and changes nothing
   * in it.
   */
  template <int dim>
  class RunOutput
  {
  public:
    /// Creates the output folder or, to resume a run, goes on with it: when
    /// nothing about the scene is left to refuse. Throws SceneError when that
    /// fails.
    RunOutput(const Scene<dim> &scene,
              const MPI_Comm    comm,
              Log              &log,
              TimerTree        &timers,
              const bool        resumed);

    /// @param outlook for the forecast of the run's time
    void
    start(const ParticleSet<dim> &particles,
          const Stepper<dim>     &stepper,
          const Outlook          &outlook);

    /// Instead: from a checkpoint. What was written after it is taken back.
    void
    resume(const ParticleSet<dim> &particles,
           const Stepper<dim>     &stepper,
           const Outlook          &outlook,
           const RunState         &state);

    /// After each step of size dt.
    void
    record(const ParticleSet<dim> &particles,
           const Stepper<dim>     &stepper,
           const TimeControl      &time,
           const double            dt,
           const StepReport<dim>  &report);

    /// After an adaptation of the mesh.
    void
    record(const AdaptReport &report);

    void
    finish(const ParticleSet<dim> &particles,
           const Stepper<dim>     &stepper,
           const TimeControl      &time);

    /// Collective.
    bool
    checkpoint_is_due(const TimeControl &time);

    /// @return the folder
    std::string
    write_checkpoint(ParticleSet<dim>   &particles,
                     const Stepper<dim> &stepper,
                     dealii::parallel::distributed::Triangulation<dim> &mesh,
                     const TimeControl                                 &time);

    /// Writes a checkpoint of the last good state and says why the run ends.
    void
    fail(ParticleSet<dim>                                  &particles,
         const Stepper<dim>                                &stepper,
         dealii::parallel::distributed::Triangulation<dim> &mesh,
         const TimeControl                                 &time,
         const std::string                                 &why);

    /// The same at the start and while the mesh is adapted, when there is no
    /// good state to keep (that is the scene, or the last checkpoint) and no
    /// stepper that fits the mesh.
    void
    fail_between_steps(const ParticleSet<dim> &particles,
                       const TimeControl      &time,
                       const std::string      &why);

  private:
    void
    open(const ParticleSet<dim> &particles, const Stepper<dim> &stepper);
    void
    write_row(const ParticleSet<dim> &particles,
              const Stepper<dim>     &stepper,
              const TimeControl      &time,
              const double            dt,
              const StepReport<dim>  &report);
    void
    write_fields(const double        time,
                 const unsigned int  step,
                 const Stepper<dim> *stepper,
                 const double        dt);
    void
    show_forecast();
    void
    show_costs(const Summary &summary);
    void
    show_errors(const Summary &summary);
    void
    show_progress(const TimeControl     &time,
                  const double           dt,
                  const StepReport<dim> &report);
    void
    record_effects(const double           time,
                   const Stepper<dim>    &stepper,
                   const WallForces<dim> &walls);
    /// @param stepper nullptr if there is none
    void
    close(const ParticleSet<dim> &particles,
          const Stepper<dim>     *stepper,
          const TimeControl      &time,
          const std::string      &failure);

    const Scene<dim> &scene;
    const MPI_Comm    comm;
    const bool        root;
    Log              &log;
    TimerTree        &timers;

    Statistics                      statistics;
    std::unique_ptr<VtuWriter<dim>> vtu;

    /// What an effect writes, and when it is due next (s).
    struct Recording
    {
      std::shared_ptr<Recorder<dim>> recorder;
      double                         next = 0;
    };
    std::vector<Recording> recordings;

    std::unique_ptr<RunAudit<dim>> audit; ///< if the scene has it
    RunState                       so_far;
    double                         last_dt           = 0; ///< s
    double                         start_wall        = 0; ///< s
    double                         start_time        = 0; ///< of this part (s)
    double                         last_checkpoint   = 0; ///< wall time (s)
    bool                           keeps_checkpoints = false; ///< one was due
    std::optional<Forecast>        forecast; ///< until it is told
  };
} // namespace selkie
