#include <selkie/adapt/adapt_mesh.h>
#include <selkie/adapt/start_mesh.h>
#include <selkie/base/exceptions.h>
#include <selkie/base/log.h>
#include <selkie/base/text.h>
#include <selkie/drivers/plan.h>
#include <selkie/drivers/run_audit.h>
#include <selkie/drivers/run_output.h>
#include <selkie/drivers/simulation.h>
#include <selkie/drivers/stepper.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/output/checkpoint.h>
#include <selkie/time/time_control.h>

#include <functional>
#include <optional>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Mesh, points and nodes of a scene: at t = 0, or, with the name of one,
    /// as a checkpoint has them.
    template <int dim>
    struct Setup
    {
      Setup(const Scene<dim>  &scene,
            const MPI_Comm     comm,
            const std::string &checkpoint = "")
        : mesh(checkpoint.empty() ? make_start_mesh(scene, comm)
                                  : make_background_mesh(scene.domain, comm))
        , particles(scene, *mesh)
      {
        if (checkpoint.empty())
          {
            particles.seed();
            for (const auto &active : scene.effects)
              active.effect->start(particles);
          }
        else
          state = read_checkpoint(checkpoint, particles, *mesh, nodal_fields);
        make_cloud();
      }

      void
      make_cloud()
      {
        cloud = make_node_cloud(particles.scene, *mesh);
      }

      std::unique_ptr<parallel::distributed::Triangulation<dim>> mesh;
      ParticleSet<dim>                                           particles;
      std::unique_ptr<NodeCloud<dim>>                            cloud;

      // Of a checkpoint:
      CheckpointState    state;
      CarriedFields<dim> nodal_fields;
    };

    /// Points of a Lagrangian mesh stay in their cells: they may move any
    /// distance in a step.
    template <int dim>
    TimeParameters
    time_parameters(const Scene<dim> &scene)
    {
      TimeParameters parameters = scene.time;
      if (scene.lagrangian_mesh())
        parameters.max_move = std::numeric_limits<double>::infinity();
      return parameters;
    }

    /// Spacing of the finest nodes that there can be (m).
    template <int dim>
    double
    smallest_spacing(const Scene<dim> &scene, const NodeCloud<dim> &cloud)
    {
      return scene.adaptivity ? finest_spacing(scene.domain, *scene.adaptivity)
                              : cloud.smallest_spacing();
    }

    template <int dim>
    Outlook
    outlook_of(const Scene<dim> &scene, const NodeCloud<dim> &cloud)
    {
      return look_ahead(scene,
                        time_parameters(scene).max_move *
                          smallest_spacing(scene, cloud));
    }

    template <int dim>
    std::unique_ptr<Stepper<dim>>
    make_stepper(Setup<dim> &setup, TimerTree &timers, Log &log)
    {
      return std::make_unique<Stepper<dim>>(setup.particles.scene,
                                            setup.particles,
                                            *setup.cloud,
                                            timers,
                                            [&log](const std::string &text) {
                                              log.line("  " + text);
                                            });
    }

    /// Whether it is time, or a point could leave the buffer in the next step.
    /// @param speed largest (m/s)
    template <int dim>
    bool
    adapts_now(const Scene<dim>   &scene,
               const Stepper<dim> &stepper,
               const double        speed,
               const TimeControl  &time)
    {
      if (!scene.adaptivity || time.at_end())
        return false;
      const Adaptivity &wishes = *scene.adaptivity;
      if (time.number() % wishes.steps == 0)
        return true;
      if (scene.lagrangian_mesh()) // the buffer moves with the matter
        return false;
      const double next = stepper.kept_numbers().moved + speed * time.step();
      return next > wishes.buffer * finest_spacing(scene.domain, wishes);
    }

    /// Lets @p change alter the mesh or its partition; cloud and stepper, which
    /// hang on it, are made anew and go on.
    template <int dim>
    void
    change_mesh(Setup<dim>                                      &setup,
                std::unique_ptr<Stepper<dim>>                   &stepper,
                TimerTree                                       &timers,
                Log                                             &log,
                const std::function<void(CarriedFields<dim> &)> &change)
    {
      CarriedFields<dim> carried;
      carried.take(*setup.mesh,
                   setup.cloud->dof_handler(),
                   stepper->kept_fields());
      const KeptNumbers numbers = stepper->kept_numbers();
      const CostLedger  costs   = stepper->costs();
      stepper.reset();
      setup.cloud.reset();
      change(carried);
      setup.make_cloud();
      stepper = make_stepper(setup, timers, log);
      stepper->go_on_from(carried, numbers, costs);
    }

    /// Adapts the mesh to the matter at @p t, after a step of size @p dt.
    template <int dim>
    AdaptReport
    adapt(Setup<dim>                    &setup,
          std::unique_ptr<Stepper<dim>> &stepper,
          const double                   t,
          const double                   dt,
          TimerTree                     &timers,
          Log                           &log)
    {
      TimerTree::Scope  scope(timers, "adapt");
      const Scene<dim> &scene  = setup.particles.scene;
      const auto        fields = stepper->nodal_fields(dt);
      NodalView<dim>    view;
      if (fields.mass.size() > 0)
        {
          view.velocity = &fields.velocity;
          view.mass     = &fields.mass;
          if (fields.pressure.size() > 0)
            view.pressure = &fields.pressure;
        }
      const auto plan =
        plan_adaptation(*setup.mesh, setup.particles, *setup.cloud, view);
      AdaptReport report;
      const auto  follow = [&](CarriedFields<dim> &carried) {
        report = adapt_mesh(*setup.mesh, setup.particles, plan, carried);
      };
      CarriedFields<dim> none; // only points change, if anything
      if (plan.changes_mesh())
        change_mesh<dim>(setup, stepper, timers, log, follow);
      else
        follow(none);
      stepper->mesh_fits();
      // Interpolated accelerations do not balance the forces between new
      // nodes, and Newmark's energy needs that.
      if (report.changed && scene.lagrangian_mesh() && scene.inertia)
        stepper->start(t, dt);
      return report;
    }

    /// Whether to share the points out anew, since they are spread unevenly.
    template <int dim>
    bool
    shares_out_now(const ParticleSet<dim> &particles, const TimeControl &time)
    {
      const Scene<dim>  &scene     = particles.scene;
      const unsigned int every     = scene.domain.balance_steps;
      const bool         runs_away = !scene.lagrangian_mesh();
      return Utilities::MPI::n_mpi_processes(particles.communicator()) > 1 &&
             !time.at_end() && runs_away && !scene.adaptivity && every > 0 &&
             time.number() % every == 0 &&
             particles.imbalance() > most_imbalance;
    }

    /// Shares the points out among the ranks anew.
    template <int dim>
    void
    balance(Setup<dim>                    &setup,
            std::unique_ptr<Stepper<dim>> &stepper,
            TimerTree                     &timers,
            Log                           &log)
    {
      TimerTree::Scope scope(timers, "balance");
      change_mesh<dim>(
        setup, stepper, timers, log, [&](CarriedFields<dim> &carried) {
          carried.carry_along([&] { setup.particles.rebalance(); });
        });
    }

    /// Of the stiffest body (m/s).
    template <int dim>
    double
    sound_speed(const Scene<dim> &scene)
    {
      double speed = 0.;
      for (const auto &body : scene.bodies)
        speed = std::max(speed, body.law->sound_speed());
      return speed;
    }

    /// One step, tried again with smaller ones until it succeeds. Throws
    /// NumericalFailure when the smallest step fails, too, or none can help.
    template <int dim>
    StepReport<dim>
    step_with_retries(Stepper<dim> &stepper, TimeControl &time, Log &log)
    {
      for (;;)
        try
          {
            return stepper.step(time.now(), time.step());
          }
        catch (const CertainFailure &)
          {
            throw;
          }
        catch (const NumericalFailure &failure)
          {
            if (!time.cut())
              throw;
            log.line("  t = " + std::to_string(time.now()) + " s: " +
                     failure.what() + "; trying again with a time step of " +
                     std::to_string(time.step()) + " s");
          }
    }

    /// Makes as many steps as a forecast needs, up to the first adaptation and
    /// not for long, but three that count: a single one says little.
    template <int dim>
    Rehearsal<dim>
    rehearse(const ParticleSet<dim> &particles,
             Stepper<dim>           &stepper,
             TimeControl            &time,
             const Outlook          &outlook,
             TimerTree              &timers,
             Log                    &log)
    {
      constexpr double             patience = 5.; // s
      const double                 begin    = timers.wall_time();
      std::optional<RunAudit<dim>> audit;
      if (particles.scene.audit)
        audit.emplace(particles);
      Rehearsal<dim> result{
        begin, {}, {time.now(), time.end(), begin, outlook}, {}, {}};
      StepReport<dim> &report = result.report;
      bool             enough = false;
      for (unsigned int n = 0; !enough && !time.at_end(); ++n)
        {
          if (n <= Forecast::n_cold)
            result.before = timers.rows();
          report = step_with_retries(stepper, time, log);
          time.advance(report.largest_speed, report.time_error);
          if (audit)
            audit->record(time.now(), report);
          const double now = timers.wall_time();
          result.forecast.record(time.now(), now, report.newton.iterations);
          enough =
            result.forecast.ready() ||
            (n >= Forecast::n_cold + 2 && now - begin > patience) ||
            (n >= Forecast::n_cold &&
             adapts_now(particles.scene, stepper, report.largest_speed, time));
          enough = Utilities::MPI::broadcast(particles.communicator(), enough);
        }
      result.after = timers.rows();
      return result;
    }
  } // namespace


  template <int dim>
  int
  run_scene(const Scene<dim> &scene, const MPI_Comm comm, const bool resumed)
  {
    FoundCheckpoint found;
    if (resumed)
      found = find_checkpoint(scene.output.directory);
    Log       log(comm);
    TimerTree timers(comm);
    // The last that may refuse the scene: before the output is touched.
    auto  setup     = timed(timers, "set-up", [&] {
      return std::make_unique<Setup<dim>>(scene, comm, found.folder);
    });
    auto &particles = setup->particles;

    RunOutput<dim> output(scene, comm, log, timers, resumed);
    const Outlook  outlook = outlook_of(scene, *setup->cloud);
    if (!found.damage.empty())
      log.line("          passed over a damaged checkpoint: " + found.damage);
    auto        stepper = make_stepper(*setup, timers, log);
    TimeControl time(time_parameters(scene),
                     smallest_spacing(scene, *setup->cloud),
                     sound_speed(scene));

    if (resumed)
      {
        const std::vector<char> bytes(setup->state.run.begin(),
                                      setup->state.run.end());
        const auto state = Utilities::unpack<RunState>(bytes, false);
        time.restore(state.time);
        stepper->restore(setup->nodal_fields, state.stepper);
        output.resume(particles, *stepper, outlook, state);
        if (time.at_end())
          {
            log.line(
              "Nothing is left to do up to the end time; --set 'Time/End "
              "time=...' for more");
            return 0;
          }
      }
    else
      try
        {
          stepper->start(time.now(), time.step());
          output.start(particles, *stepper, outlook);
        }
      catch (const NumericalFailure &failure)
        {
          output.fail_between_steps(particles, time, failure.what());
          return 2;
        }
    while (!time.at_end())
      {
        StepReport<dim> report;
        try
          {
            report = step_with_retries(*stepper, time, log);
          }
        catch (const NumericalFailure &failure)
          {
            output.fail(
              particles, *stepper, *setup->mesh, time, failure.what());
            return 2;
          }
        const double dt = time.step();
        time.advance(report.largest_speed, report.time_error);
        output.record(particles, *stepper, time, dt, report);
        try
          {
            if (adapts_now(scene, *stepper, report.largest_speed, time))
              output.record(
                adapt(*setup, stepper, time.now(), dt, timers, log));
            if (shares_out_now(particles, time))
              balance(*setup, stepper, timers, log);
            if (output.checkpoint_is_due(time))
              output.write_checkpoint(particles, *stepper, *setup->mesh, time);
          }
        catch (const NumericalFailure &failure)
          {
            output.fail_between_steps(particles, time, failure.what());
            return 2;
          }
      }
    output.finish(particles, *stepper, time);
    return 0;
  }


  template <int dim>
  void
  print_plan(const Scene<dim> &scene, const MPI_Comm comm)
  {
    Log          log(comm);
    TimerTree    timers(comm);
    Setup<dim>   setup(scene, comm);
    Stepper<dim> stepper(
      scene, setup.particles, *setup.cloud, timers, [](const std::string &) {});
    TimeControl time(time_parameters(scene),
                     smallest_spacing(scene, *setup.cloud),
                     sound_speed(scene));
    stepper.start(time.now(), time.step());
    describe_plan(scene,
                  setup.particles,
                  stepper,
                  rehearse(setup.particles,
                           stepper,
                           time,
                           outlook_of(scene, *setup.cloud),
                           timers,
                           log),
                  log);
  }

#define INSTANTIATE(dim)                                                   \
  template int  run_scene(const Scene<dim> &, const MPI_Comm, const bool); \
  template void print_plan(const Scene<dim> &, const MPI_Comm)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
