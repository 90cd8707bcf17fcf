#pragma once

#include <selkie/base/log.h>
#include <selkie/base/timer_tree.h>
#include <selkie/drivers/stepper.h>
#include <selkie/output/audit.h>
#include <selkie/output/probes.h>
#include <selkie/output/statistics.h>
#include <selkie/output/summary.h>
#include <selkie/output/vtu.h>
#include <selkie/time/time_control.h>

#include <memory>
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
    finish(const ParticleSet<dim> &particles, const TimeControl &time);

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
    write_fields(const double        time,
                 const unsigned int  step,
                 const Stepper<dim> *stepper,
                 const double        dt);
    void
    show_progress(const TimeControl     &time,
                  const double           dt,
                  const StepReport<dim> &report);
    void
    close(const ParticleSet<dim> &particles,
          const TimeControl      &time,
          const std::string      &failure);

    const Scene<dim> &scene;
    const MPI_Comm    comm;
    const bool        root;
    Log              &log;
    TimerTree        &timers;

    Statistics                      statistics;
    std::unique_ptr<VtuWriter<dim>> vtu;
    std::unique_ptr<Probes<dim>>    probes;

    Audit              present;
    double             initial_energy = 0;
    double             dissipated = 0, external_work = 0, reset_energy = 0;
    double             next_fields = 0, next_probes = 0; ///< s
    unsigned long long unknowns   = 0;
    double             start_wall = 0;
  };

  /// The text of `selkie check`.
  template <int dim>
  void
  describe_plan(const Scene<dim>       &scene,
                const ParticleSet<dim> &particles,
                const Stepper<dim>     &stepper,
                const StepReport<dim>  &report,
                const double            seconds_per_step,
                Log                    &log);
} // namespace selkie
