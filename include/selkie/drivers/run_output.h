#pragma once

#include <selkie/base/log.h>
#include <selkie/base/timer_tree.h>
#include <selkie/drivers/stepper.h>
#include <selkie/output/audit.h>
#include <selkie/output/recorder.h>
#include <selkie/output/statistics.h>
#include <selkie/output/summary.h>
#include <selkie/output/verdict.h>
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
   * timings, summary. It reads the simulation and changes nothing in it.
   */
  template <int dim>
  class RunOutput
  {
  public:
    /// Creates the output folder. Throws SceneError when that fails.
    RunOutput(const Scene<dim> &scene,
              const MPI_Comm    comm,
              Log              &log,
              TimerTree        &timers);

    void
    start(const ParticleSet<dim> &particles, const Stepper<dim> &stepper);

    /// After each step of size dt.
    void
    record(const ParticleSet<dim> &particles,
           const Stepper<dim>     &stepper,
           const TimeControl      &time,
           const double            dt,
           const StepReport<dim>  &report);

    void
    finish(const ParticleSet<dim> &particles,
           const Stepper<dim>     &stepper,
           const TimeControl      &time);

    /// Writes a checkpoint of the last good state and says why the run ends.
    void
    fail(ParticleSet<dim>                                  &particles,
         const Stepper<dim>                                &stepper,
         dealii::parallel::distributed::Triangulation<dim> &mesh,
         const TimeControl                                 &time,
         const std::string                                 &why);

  private:
    void
    write_row(const ParticleSet<dim> &particles,
              const TimeControl      &time,
              const double            dt,
              const StepReport<dim>  &report);
    void
    set_energies(const ParticleSet<dim> &particles,
                 const StepReport<dim>  &report);
    void
    judge(const ParticleSet<dim> &particles,
          const double            t,
          const StepReport<dim>  &report);
    void
    write_fields(const double        time,
                 const unsigned int  step,
                 const Stepper<dim> *stepper,
                 const double        dt);
    void
    show_forecast(const TimeControl &time);
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
    void
    close(const ParticleSet<dim> &particles,
          const Stepper<dim>     &stepper,
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

    /// Where the energy went since the start (J).
    struct Energies
    {
      double initial    = 0;
      double potential  = 0; ///< at the start
      double dissipated = 0, external_work = 0;
      double of_reset = 0, of_volume = 0; ///< given by the fluid's rules

      double
      balance(const Audit &now) const
      {
        return now.energy() + dissipated - external_work - of_volume - initial;
      }

      /// What a gain or loss is measured by: all that moves or is stored, and
      /// what gravity or loads have given.
      double
      in_play(const Audit &now) const
      {
        const double sum =
          std::max(now.kinetic + now.strain + now.compression,
                   initial - potential) +
          std::abs(now.potential - potential) + std::abs(external_work);
        return sum > 0. ? sum : 1.;
      }
    };
    /// Of the time steps, on request: sums over them (m).
    struct TimeErrors
    {
      double error = 0, largest = 0, path = 0;
    };

    std::optional<Audit> present; ///< of the last step, if the scene asks
    Verdict              verdict;
    double               initial_volume = 0; ///< m^dim
    TimeErrors           time_errors;
    double               last_dt = 0; ///< s
    Energies             energies;
    double               next_fields = 0; ///< s
    unsigned long long   unknowns    = 0;
    double               start_wall  = 0;
    /// Wall and simulated time (s) when the first steps, which set things up,
    /// were over: for the forecast.
    double warm_wall = 0, warm_time = 0;
  };
} // namespace selkie
