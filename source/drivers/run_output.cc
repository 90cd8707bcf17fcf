#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/base/text.h>
#include <selkie/drivers/run_output.h>
#include <selkie/output/banner.h>
#include <selkie/output/checkpoint.h>
#include <selkie/output/files.h>
#include <selkie/output/output_folder.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The mean over the ranks of what each part of the assembly cost.
    template <int dim>
    std::vector<CostLedger::Entry>
    costs(const Stepper<dim> &stepper, const MPI_Comm comm)
    {
      auto entries = stepper.costs().entries();
      for (auto &entry : entries)
        entry.seconds = Utilities::MPI::sum(entry.seconds, comm) /
                        Utilities::MPI::n_mpi_processes(comm);
      return entries;
    }

    /// The first multiple of an interval after a time (s).
    double
    next_multiple(const double interval, const double time)
    {
      return interval * (std::floor(time / interval) + 1.);
    }

    template <int dim>
    NodeMotion<dim>
    node_motion(const Stepper<dim> &stepper)
    {
      NodeMotion<dim> nodes;
      nodes.cloud = &stepper.system().cloud;
      if (const auto *state = stepper.nodal_state())
        {
          nodes.displacement = &state->displacement;
          nodes.velocity     = &state->velocity;
        }
      nodes.pressure = stepper.fluid_pressure();
      return nodes;
    }

    /// What a mesh that follows the matter is like, and its points. Collective.
    template <int dim>
    void
    set_mesh_columns(const ParticleSet<dim> &particles,
                     const NodeCloud<dim>   &cloud,
                     Statistics             &statistics)
    {
      statistics.set(
        "cells",
        cloud.dof_handler().get_triangulation().n_global_active_cells());
      statistics.set("points split", particles.accounting.split);
      statistics.set("points merged", particles.accounting.merged);
      statistics.set("imbalance", particles.imbalance());
    }
  } // namespace

  template <int dim>
  RunOutput<dim>::RunOutput(const Scene<dim> &scene,
                            const MPI_Comm    comm,
                            Log              &log,
                            TimerTree        &timers,
                            const bool        resumed)
    : scene(scene)
    , comm(comm)
    , root(Utilities::MPI::this_mpi_process(comm) == 0)
    , log(log)
    , timers(timers)
  {
    if (resumed)
      continue_output_folder(scene.output.directory, scene.resolved, comm);
    else
      create_output_folder(scene.output.directory,
                           scene.file,
                           scene.resolved,
                           comm);
    log.open(scene.output.directory, resumed);
    log.line(banner(comm));
    log.line("Scene     " + scene.title + " (" + scene.file + ")");
    log.line("Effects   " + join(scene.effect_names()));
    log.line("Output    " + scene.output.directory);
  }

  template <int dim>
  void
  RunOutput<dim>::open(const ParticleSet<dim> &particles,
                       const Stepper<dim>     &stepper)
  {
    log.line("Terms     " + join(stepper.term_names()));
    log.line("Points    " +
             std::to_string(particles.handler().n_global_particles()) + ", " +
             std::to_string(particles.fields.n_components() * 8) +
             " bytes of columns each");
    fail_together<OutputError>(comm, [&] {
      statistics.open(scene.output.directory + "/statistics.csv", root);
    });
    vtu = std::make_unique<VtuWriter<dim>>(scene.output.directory, particles);
    for (const auto &active : scene.effects)
      if (auto recorder = active.effect->recorder(particles))
        recordings.push_back({std::move(recorder)});
    start_wall = last_checkpoint = timers.wall_time();
  }

  template <int dim>
  void
  RunOutput<dim>::start(const ParticleSet<dim> &particles,
                        const Stepper<dim>     &stepper,
                        const Outlook          &outlook)
  {
    open(particles, stepper);
    log.line("Solver    " + stepper.solver_in_use(scene.time.step));
    if (scene.audit)
      audit = std::make_unique<RunAudit<dim>>(particles);
    write_fields(0., 0, nullptr, scene.time.step);
    record_effects(0., stepper, WallForces<dim>());
    start_wall = timers.wall_time();
    forecast.emplace(0., scene.time.end_time, start_wall, outlook);
  }

  template <int dim>
  void
  RunOutput<dim>::resume(const ParticleSet<dim> &particles,
                         const Stepper<dim>     &stepper,
                         const Outlook          &outlook,
                         const RunState         &state)
  {
    so_far     = state;
    start_time = state.time.t;
    log.line(format("Resumed   at t = %g s, after %u steps",
                    state.time.t,
                    state.time.n));
    cut_tables(scene.output.directory, state.time.t, comm);
    open(particles, stepper);
    vtu->restore(state.particle_files, state.mesh_files);
    for (unsigned int i = 0; i < recordings.size(); ++i)
      recordings[i].next = state.next_records.at(i);
    if (scene.audit)
      audit = std::make_unique<RunAudit<dim>>(particles, state.audit);
    forecast.emplace(start_time, scene.time.end_time, start_wall, outlook);
  }

  template <int dim>
  void
  RunOutput<dim>::record(const ParticleSet<dim> &particles,
                         const Stepper<dim>     &stepper,
                         const TimeControl      &time,
                         const double            dt,
                         const StepReport<dim>  &report)
  {
    TimerTree::Scope scope(timers, "output");
    so_far.error += report.time_error;
    so_far.path += report.moved;
    so_far.largest_error = std::max(so_far.largest_error, report.time_error);
    last_dt              = dt;
    so_far.unknowns      = std::max(so_far.unknowns, report.unknowns);
    so_far.nonzeros =
      std::max(so_far.nonzeros, stepper.system().n_nonzero_elements());
    if (audit)
      audit->record(time.now(), report);
    write_row(particles, stepper, time, dt, report);

    record_effects(time.now(), stepper, report.walls);
    const double slack = 1e-6 * scene.time.step;
    if (scene.output.interval > 0. &&
        (time.now() >= so_far.next_fields - slack || time.at_end()))
      write_fields(time.now(), time.number(), &stepper, dt);
    if (forecast)
      {
        forecast->record(time.now(),
                         timers.wall_time(),
                         report.newton.iterations);
        if (forecast->ready())
          {
            show_forecast();
            forecast.reset();
          }
      }
    show_progress(time, dt, report);
  }

  template <int dim>
  void
  RunOutput<dim>::record(const AdaptReport &report)
  {
    if (audit)
      audit->book_adapting(report.energy);
  }

  template <int dim>
  void
  RunOutput<dim>::record_effects(const double           time,
                                 const Stepper<dim>    &stepper,
                                 const WallForces<dim> &walls)
  {
    const double slack = 1e-6 * scene.time.step;
    for (Recording &recording : recordings)
      if (time >= recording.next - slack)
        {
          TimerTree::Scope scope(timers, recording.recorder->name());
          const double     interval = recording.recorder->interval();
          recording.recorder->record(time, walls, node_motion(stepper));
          if (interval > 0.)
            recording.next = next_multiple(interval, time + slack);
        }
  }

  template <int dim>
  void
  RunOutput<dim>::write_row(const ParticleSet<dim> &particles,
                            const Stepper<dim>     &stepper,
                            const TimeControl      &time,
                            const double            dt,
                            const StepReport<dim>  &report)
  {
    statistics.set("step", time.number());
    statistics.set("time (s)", time.now());
    statistics.set("dt (s)", dt);
    statistics.set("points", particles.handler().n_global_particles());
    statistics.set("unknowns", report.unknowns);
    statistics.set("newton iterations", report.newton.iterations);
    statistics.set("linear iterations", report.newton.linear_iterations);
    statistics.set("mean lambda iterations", report.lambda_iterations);
    statistics.set("max lambda iterations", report.max_lambda_iterations);
    statistics.set("step cuts", time.cuts());
    if (audit)
      audit->set_columns(report, statistics);
    if (scene.corrects_volume())
      statistics.set("crowding", report.crowding);
    statistics.set("points removed", particles.accounting.removed);
    statistics.set("points kept at walls", particles.accounting.kept_at_wall);
    if (scene.adaptivity)
      set_mesh_columns(particles, stepper.system().cloud, statistics);
    fail_together<OutputError>(comm, [&] { statistics.end_row(); });
  }

  template <int dim>
  void
  RunOutput<dim>::write_fields(const double        time,
                               const unsigned int  step,
                               const Stepper<dim> *stepper,
                               const double        dt)
  {
    if (scene.output.interval <= 0.)
      return;
    so_far.next_fields =
      next_multiple(scene.output.interval,
                    time * (1. + 1e-12) + 1e-6 * scene.time.step);
    if (stepper == nullptr || !scene.output.mesh)
      {
        vtu->write(time, step, nullptr);
        return;
      }
    const auto       fields = stepper->nodal_fields(dt);
    NodalOutput<dim> mesh;
    mesh.cloud = &stepper->system().cloud;
    if (scene.inertia)
      mesh.scalars.emplace_back("mass", fields.mass);
    if (scene.has_pressure())
      mesh.scalars.emplace_back("pressure", fields.pressure);
    if (scene.inertia)
      mesh.vectors.emplace_back("velocity", fields.velocity);
    if (scene.lagrangian_mesh())
      mesh.vectors.emplace_back("displacement", fields.displacement);
    // The nodes of a static scene of solids have nothing to show.
    const bool anything = !mesh.scalars.empty() || !mesh.vectors.empty();
    vtu->write(time, step, anything ? &mesh : nullptr);
  }

  template <int dim>
  void
  RunOutput<dim>::show_forecast()
  {
    Utilities::System::MemoryStats memory;
    Utilities::System::get_memory_stats(memory);
    log.line(format("Forecast  %s for the whole run, as its first steps are "
                    "(%.2g s each) and later ones of others were (%.0f %% "
                    "more); %.0f MB a rank",
                    time_span(forecast->total()).c_str(),
                    forecast->step(),
                    100. * (forecast->growth() - 1.),
                    memory.VmHWM / 1024.));
  }

  /// What the assembly's time went into, by effect.
  template <int dim>
  void
  RunOutput<dim>::show_costs(const Summary &summary)
  {
    double total = 0.;
    for (const auto &entry : summary.costs)
      total += entry.seconds;
    if (total <= 0.)
      return;
    std::string text = "Assembly  ";
    for (const auto &entry : summary.costs)
      text += format("%s%s %.0f %%",
                     &entry == &summary.costs.front() ? "" : ", ",
                     entry.part.c_str(),
                     100. * entry.seconds / total);
    log.line(text);
  }

  template <int dim>
  void
  RunOutput<dim>::show_errors(const Summary &summary)
  {
    if (!summary.errors)
      return;
    const auto &errors = *summary.errors;
    log.line(
      format("Errors    estimated: time steps %.2g m in sum (%.2g of the "
             "path), at most %.2g m in one; mesh %.2g of the velocity",
             errors.time,
             errors.time_relative,
             errors.largest_step,
             errors.space_relative));
  }

  template <int dim>
  void
  RunOutput<dim>::show_progress(const TimeControl     &time,
                                const double           dt,
                                const StepReport<dim> &report)
  {
    const double spent = timers.wall_time() - start_wall;
    const double left =
      spent * (time.end() - time.now()) / (time.now() - start_time);
    log.progress(
      format("step %5u  t %.5g s  dt %.2g s  Newton %u  linear %u  unknowns "
             "%llu  %3.0f %%  left %s",
             time.number(),
             time.now(),
             dt,
             report.newton.iterations,
             report.newton.linear_iterations,
             report.unknowns,
             100. * time.now() / time.end(),
             time_span(left).c_str()));
  }

  template <int dim>
  void
  RunOutput<dim>::close(const ParticleSet<dim> &particles,
                        const Stepper<dim>     *stepper,
                        const TimeControl      &time,
                        const std::string      &failure)
  {
    Summary summary;
    summary.title           = scene.title;
    summary.file            = scene.file;
    summary.effects         = scene.effect_names();
    summary.ranks           = Utilities::MPI::n_mpi_processes(comm);
    summary.points          = particles.handler().n_global_particles();
    summary.unknowns        = so_far.unknowns;
    summary.nonzeros        = so_far.nonzeros;
    summary.bytes_per_point = 8 * particles.fields.n_components();
    summary.steps           = time.number();
    summary.end_time        = time.now();
    summary.failure         = failure;
    if (audit)
      {
        summary.audit   = audit->figures();
        summary.verdict = audit->verdict();
      }
    summary.accounting = particles.accounting;
    summary.wall_time  = so_far.wall + timers.wall_time();
    summary.timings    = timers.rows();
    if (stepper != nullptr)
      summary.costs = costs(*stepper, comm);
    if (failure.empty() && scene.time.estimate_error && time.number() > 0)
      {
        const RecoveryError space = stepper->spatial_error(last_dt);
        const auto          share = [](const double part, const double whole) {
          return whole > 0. ? part / whole : 0.;
        };
        summary.errors = {so_far.error,
                          share(so_far.error, so_far.path),
                          so_far.largest_error,
                          space.error,
                          share(space.error, space.norm)};
      }
    fail_together<OutputError>(comm, [&] {
      if (!root)
        return;
      write_summary(scene.output.directory + "/summary.json", summary);
      write_file(scene.output.directory + "/timing.csv",
                 [&](std::ostream &file) {
                   TimerTree::write_csv(summary.timings, file);
                 });
    });
    log.line();
    timers.print(log);
    show_costs(summary);
    show_errors(summary);
    if (audit)
      for (const std::string &line : audit->text())
        log.line(line);
  }

  template <int dim>
  void
  RunOutput<dim>::finish(const ParticleSet<dim> &particles,
                         const Stepper<dim>     &stepper,
                         const TimeControl      &time)
  {
    close(particles, &stepper, time, "");
    log.line("Time step ruled by " + time.rules());
    log.line(format("Done      %u steps to t = %g s in %s, %u cuts",
                    time.number(),
                    time.now(),
                    time_span(timers.wall_time()).c_str(),
                    time.cuts()));
  }

  template <int dim>
  std::string
  RunOutput<dim>::write_checkpoint(
    ParticleSet<dim>                          &particles,
    const Stepper<dim>                        &stepper,
    parallel::distributed::Triangulation<dim> &mesh,
    const TimeControl                         &time)
  {
    TimerTree::Scope scope(timers, "checkpoint");
    RunState         state = so_far;
    state.time             = time.state();
    state.stepper          = stepper.kept_numbers();
    if (audit)
      state.audit = audit->state();
    state.particle_files = vtu->particle_pictures();
    state.mesh_files     = vtu->mesh_pictures();
    state.wall += timers.wall_time();
    state.next_records.clear();
    for (const auto &recording : recordings)
      state.next_records.push_back(recording.next);
    const auto bytes = Utilities::pack(state, false);
    last_checkpoint  = timers.wall_time();
    return selkie::write_checkpoint(scene.output.directory,
                                    scene,
                                    particles,
                                    mesh,
                                    stepper.system().cloud.dof_handler(),
                                    stepper.kept_fields(),
                                    time.now(),
                                    time.number(),
                                    time.step(),
                                    {bytes.begin(), bytes.end()});
  }

  template <int dim>
  bool
  RunOutput<dim>::checkpoint_is_due(const TimeControl &time)
  {
    const auto  &wishes = scene.output;
    const double waited = timers.wall_time() - last_checkpoint;
    bool         due    = wishes.checkpoint_steps > 0 &&
               time.number() % wishes.checkpoint_steps == 0;
    // The clocks of the ranks differ: the first one's counts.
    if (!due && wishes.checkpoint_minutes > 0.)
      due = Utilities::MPI::broadcast(comm,
                                      waited > 60. * wishes.checkpoint_minutes);
    keeps_checkpoints = keeps_checkpoints || due || wishes.checkpoint_steps > 0;
    return due || (keeps_checkpoints && time.at_end());
  }

  template <int dim>
  void
  RunOutput<dim>::fail(ParticleSet<dim>                          &particles,
                       const Stepper<dim>                        &stepper,
                       parallel::distributed::Triangulation<dim> &mesh,
                       const TimeControl                         &time,
                       const std::string                         &why)
  {
    const std::string folder = write_checkpoint(particles, stepper, mesh, time);
    close(particles, &stepper, time, why);
    log.line(format("Failed    at t = %g s, with the smallest time step "
                    "%.3g s:",
                    time.now(),
                    time.step()));
    log.line("          " + why);
    log.line("          The last good state is in " + folder + ".");
  }

  template <int dim>
  void
  RunOutput<dim>::fail_between_steps(const ParticleSet<dim> &particles,
                                     const TimeControl      &time,
                                     const std::string      &why)
  {
    close(particles, nullptr, time, why);
    if (time.number() > 0)
      {
        log.line(
          format("Failed    at t = %g s, adapting the mesh or sharing it out:",
                 time.now()));
        log.line("          " + why);
        log.line("          The last good state is that of the last "
                 "checkpoint. Adapt more often, with a wider buffer or fewer "
                 "levels.");
        return;
      }
    log.line("Failed    at the start:");
    log.line("          " + why);
    log.line("          No step was tried, and a smaller one would not help. "
             "Change what this names, be it the first state of a body, its "
             "law, the walls or the shape functions, and run the scene again.");
  }

  template class RunOutput<2>;
  template class RunOutput<3>;
} // namespace selkie
