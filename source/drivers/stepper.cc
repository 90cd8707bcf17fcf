#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/drivers/energy_jump.h>
#include <selkie/drivers/residual_report.h>
#include <selkie/drivers/start_acceleration.h>
#include <selkie/drivers/stepper.h>
#include <selkie/laws/volumetric_law.h>
#include <selkie/shape/contact_pairs.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  Stepper<dim>::Stepper(const Scene<dim>                        &scene,
                        ParticleSet<dim>                        &particles,
                        const NodeCloud<dim>                    &cloud,
                        TimerTree                               &timers,
                        std::function<void(const std::string &)> log)
    : scene(scene)
    , particles(particles)
    , cloud(cloud)
    , timers(timers)
    , log(log)
    , conditions(scene, cloud)
    , terms(terms_of(scene))
    , unknowns(cloud, conditions, scene.pressure_phases())
    , assembler(terms, unknowns)
    , linear_solver(scene.linear_solver, log)
    , stored_pressures(no_pressures(scene, cloud))
  {
    if (scene.release)
      release = std::make_unique<NodeRelease<dim>>(scene, conditions);
    if (scene.approximation != Approximation::lme_mpm)
      q4 = std::make_unique<const Q4Support<dim>>(scene, cloud);
    if (scene.lagrangian_mesh())
      {
        nodes = std::make_unique<NodalState<dim>>(cloud, *q4);
        q4->fill_points(particles, table);
        nodes->start(scene, cloud, table);
      }
  }

  template <int dim>
  Newmark
  Stepper<dim>::newmark(const double dt) const
  {
    return scene.inertia ? Newmark(scene.inertia->newmark_beta,
                                   scene.inertia->newmark_gamma,
                                   dt)
                         : Newmark::quasi_static(dt);
  }

  /// Whether the interior of the fluid is integrated at fixed Gauss points.
  template <int dim>
  bool
  Stepper<dim>::has_full_cells() const
  {
    return scene.approximation == Approximation::lme_mpm && scene.has_fluid() &&
           scene.fluid_pressure->gauss_full_cells;
  }

  /// Points without shape functions, or of a pressure that their law never
  /// reaches, may be on one rank only.
  template <int dim>
  void
  Stepper<dim>::together(const std::function<void()> &action) const
  {
    fail_together<NumericalFailure>(particles.communicator(), action);
  }

  /// The only place where the approximations differ.
  template <int dim>
  void
  Stepper<dim>::fill_supports()
  {
    TimerTree::Scope scope(timers, "supports");
    if (particles.handler().n_global_particles() == 0)
      throw NumericalFailure("no material point is left in the domain (see "
                             "'Points leaving')");
    if (scene.approximation == Approximation::lme_mpm)
      {
        occupancy = find_occupancy(particles, cloud, has_full_cells());
        together(
          [&] { fill_material_points(particles, cloud, occupancy, table); });
        if (scene.contact)
          add_contact_pairs(cloud, occupancy, table);
        unknowns.reinit(occupancy, table);
        return;
      }
    q4->fill_points(particles, table);
    if (nodes)
      q4->add_loaded_faces(nodes->displacement, table);
    occupancy = q4->occupancy(table);
    unknowns.reinit(occupancy, table);
  }

  /// What may have changed of the conditions since the last step.
  template <int dim>
  void
  Stepper<dim>::prepare_conditions(const double t)
  {
    const bool moving =
      std::any_of(scene.node_sets.begin(),
                  scene.node_sets.end(),
                  [](const auto &set) {
                    return set.condition == NodeCondition::moving;
                  });
    if (moving)
      conditions.find(t);
    if (release)
      release->begin_step(cloud);
  }

  template <int dim>
  void
  Stepper<dim>::build_supports(const double t, const double dt)
  {
    prepare_conditions(t);
    fill_supports();
    {
      TimerTree::Scope scope(timers, "projection");
      project(particles,
              table,
              unknowns,
              t,
              dt,
              stored_pressures,
              nodes.get(),
              fields);
    }
    if (has_full_cells())
      {
        TimerTree::Scope scope(timers, "supports");
        StoredPressures  guess = no_pressures(scene, cloud);
        store_pressures(unknowns, fields, guess);
        together(
          [&] { add_gauss_points(cloud, guess.at(0), gauss_supports, table); });
      }
    if (scene.approximation == Approximation::lme_mpm && scene.wall_points)
      {
        TimerTree::Scope scope(timers, "supports");
        auto             walls = *scene.wall_points;
        for (unsigned int w = 0; w < 2 * dim; ++w)
          walls[w] =
            walls[w] && scene.domain.walls[w].condition == NodeCondition::slip;
        together([&] { add_wall_points(cloud, walls, table); });
      }
    if (scene.corrects_volume())
      volume = correct_volume(
        *scene.fluid_pressure, dt, kept.volume_excess, unknowns, table);
  }

  template <int dim>
  SystemTraits
  Stepper<dim>::traits(const Newmark &newmark) const
  {
    SystemTraits traits;
    const double h = cloud.smallest_spacing();
    for (const auto &body : scene.bodies)
      traits.acoustic_cfl =
        std::max(traits.acoustic_cfl, body.law->sound_speed() * newmark.dt / h);
    traits.lme   = scene.approximation == Approximation::lme_mpm;
    traits.mixed = scene.has_pressure();
    for (const auto &term : terms)
      {
        const TermUse use = term->use();
        traits.symmetric  = traits.symmetric && term->symmetric(newmark, h);
        traits.at_points  = traits.at_points && !use.mean;
        traits.consistent_mass |= use.mass;
      }
    return traits;
  }

  template <int dim>
  void
  Stepper<dim>::set_predictor(const Newmark &newmark)
  {
    for (unsigned int i = 0; i < unknowns.n_owned_displacements(); ++i)
      if (!unknowns.held(i))
        fields.x.local_element(i) =
          newmark.predictor(fields.v_n.local_element(i),
                            fields.a_n.local_element(i));
  }

  /// Newton starts from the predictor or, if that leaves a smaller residual,
  /// from rest: an explicit step far beyond the sound CFL of a stiff body bends
  /// it more than Newton can mend (water put on a steel plate).
  template <int dim>
  void
  Stepper<dim>::choose_first_guess(const StepTime &time)
  {
    Vector residual;
    unknowns.initialize(residual);
    if (!scene.inertia)
      {
        // Loads and reactions are the forces in play.
        assembler.assemble(
          table, time, fields, scales.pressure_unit, false, residual);
        scales.u = std::max(scales.u, residual.l2_norm());
        return;
      }
    const auto error = [&] {
      try
        {
          assembler.assemble(
            table, time, fields, scales.pressure_unit, false, residual);
          return residual_norms(unknowns, residual)[0];
        }
      catch (const InvertedPoint &)
        {
          return std::numeric_limits<double>::infinity();
        }
    };
    const double predicted = error();
    Vector       predictor;
    unknowns.initialize(predictor);
    predictor.copy_locally_owned_data_from(fields.x);
    for (unsigned int i = 0; i < unknowns.n_owned_displacements(); ++i)
      if (!unknowns.held(i))
        fields.x.local_element(i) = 0.;
    if (error() >= predicted)
      {
        fields.x.zero_out_ghost_values();
        fields.x.copy_locally_owned_data_from(predictor);
      }
    fields.x.update_ghost_values();
  }

  /// The acceleration that the terms give to all matter (m/s^2).
  template <int dim>
  double
  Stepper<dim>::acceleration_scale() const
  {
    double sum = 0.;
    for (const auto &term : terms)
      sum += term->acceleration_scale();
    return sum;
  }

  template <int dim>
  NewtonProblem
  Stepper<dim>::newton_problem(const StepTime &time)
  {
    NewtonProblem problem;
    problem.residual = [this, &time](Vector &, Vector &residual) {
      TimerTree::Scope scope(timers, "residual");
      assembler.assemble(
        table, time, fields, scales.pressure_unit, false, residual);
    };
    problem.solve =
      [this,
       &time](Vector &, const Vector &, Vector &dx, const double tolerance) {
        Vector             rhs(dx);
        const SystemTraits what = traits(time.newmark);
        const auto assemble = [&](const TangentParts &parts, Vector &residual) {
          TimerTree::Scope scope(timers, "tangent");
          unknowns.want_hats(parts.hats, table);
          if (parts.matrix)
            unknowns.want_matrix(table);
          else
            unknowns.want_points();
          assembler.assemble(
            table, time, fields, scales.pressure_unit, true, residual);
        };
        assemble(linear_solver.wants(unknowns, what), rhs);
        TimerTree::Scope   scope(timers, "linear solve");
        const unsigned int n_u = unknowns.n_owned_displacements();
        for (unsigned int i = 0; i < unknowns.n_owned(); ++i)
          rhs.local_element(i) *= unknowns.held(i) ? 0.
                                  : i < n_u        ? -1.
                                                   : -scales.pressure_unit;
        const auto again = [&](const TangentParts &parts) {
          Vector same_residual(dx);
          assemble(parts, same_residual);
        };
        const auto report =
          linear_solver.solve({unknowns, what, rhs, tolerance, again}, dx);
        for (unsigned int i = n_u; i < unknowns.n_owned(); ++i)
          dx.local_element(i) *= scales.pressure_unit;
        return report.iterations;
      };
    problem.error = [this](const Vector &residual) {
      return scales.error(residual_norms(unknowns, residual),
                          scene.newton.tolerance);
    };
    problem.describe = [this, &time](const Vector &residual) {
      return describe_residual(
        scene, terms, unknowns, table, time, fields, scales, residual);
    };
    problem.step_size = [this](const Vector &dx) {
      double largest = 0.;
      for (unsigned int i = 0; i < unknowns.n_owned_displacements(); ++i)
        {
          if (!std::isfinite(dx.local_element(i)))
            largest = std::numeric_limits<double>::max();
          largest = std::max(largest, std::abs(dx.local_element(i)));
        }
      largest = Utilities::MPI::max(largest, particles.communicator());
      if (largest == std::numeric_limits<double>::max())
        return std::numeric_limits<double>::infinity();
      // Elements may turn by any angle in a step: the line search looks after
      // them.
      return scene.lagrangian_mesh() ? 0. : largest / cloud.smallest_spacing();
    };
    return problem;
  }

  template <int dim>
  StepReport<dim>
  Stepper<dim>::step(const double t, const double dt)
  {
    const StepTime time{t, newmark(dt)};
    build_supports(t, dt);
    if (scene.inertia)
      set_predictor(time.newmark);
    fields.x.update_ghost_values();

    Vector residual;
    unknowns.initialize(residual);
    scales = ResidualScales::of_step(
      scene, unknowns, fields, time.newmark, acceleration_scale());

    StepReport<dim> report;
    {
      TimerTree::Scope scope(timers, "newton");
      report.newton = solve(time, residual);
      collect(time, residual, report);
    }
    if (scene.inertia &&
        (scene.time.estimate_error || scene.time.largest_error > 0.))
      estimate_time_error(
        unknowns, fields, time.newmark, *scene.inertia, report);
    TimerTree::Scope scope(timers, "update");
    PointUpdate<dim> update(particles, table, unknowns, time.newmark, fields);
    if (scene.time.largest_energy_jump > 0.)
      check_energy_jump(update, report, unbalanced_work());
    report.reset_energy = update.write();
    if (nodes)
      nodes->keep(unknowns, time.newmark, fields);
    store_pressures(unknowns, fields, stored_pressures);
    kept.volume_excess = volume.excess;
    kept.moved += report.largest_speed * dt;
    if (release)
      release->end_step();
    return report;
  }

  /// The work that forces within Newton's tolerance may do in the step (J).
  template <int dim>
  double
  Stepper<dim>::unbalanced_work() const
  {
    double sum = 0.;
    for (unsigned int i = 0; i < unknowns.n_owned_displacements(); ++i)
      sum += fields.x.local_element(i) * fields.x.local_element(i);
    return scene.newton.tolerance * scales.u *
           std::sqrt(Utilities::MPI::sum(sum, particles.communicator()));
  }

  /// Newton, and again while walls let nodes go or catch them. The residual is
  /// that of the solution.
  template <int dim>
  NewtonResult
  Stepper<dim>::solve(const StepTime &time, Vector &residual)
  {
    choose_first_guess(time);
    const ForcingTerms forcing{scene.linear_solver.tolerance,
                               scene.linear_solver.loosest};
    linear_solver.forget();
    NewtonResult total;
    bool         again = false;
    do
      {
        const auto result =
          newton(newton_problem(time), scene.newton, forcing, fields.x);
        total.iterations += result.iterations;
        total.linear_iterations += result.linear_iterations;
        total.errors.insert(total.errors.end(),
                            result.errors.begin(),
                            result.errors.end());
        assembler.assemble(
          table, time, fields, scales.pressure_unit, false, residual);
        fields.x.update_ghost_values();
        // A pull that Newton's tolerance could explain is none.
        again =
          release && release->correct(occupancy,
                                      residual,
                                      10. * scene.newton.tolerance * scales.u,
                                      unknowns,
                                      fields);
    } while (again);
    return total;
  }

  template <int dim>
  void
  Stepper<dim>::collect(const StepTime  &time,
                        const Vector    &residual,
                        StepReport<dim> &report)
  {
    const MPI_Comm comm   = particles.communicator();
    const auto     powers = assembler.powers(table, time, fields);
    report.dissipated     = powers.dissipation * time.newmark.dt;
    report.external_work  = powers.external_work;
    collect_reactions(unknowns, residual, fields, report);
    report.largest_speed = largest_speed(unknowns, fields, time.newmark);
    if (scene.audit && scene.inertia)
      collect_motion(unknowns, fields, time.newmark, report);
    if (scene.audit && scene.has_pressure())
      report.checkerboard = checkerboard(unknowns, table, fields);
    report.crowding      = volume.excess;
    report.volume_energy = Utilities::MPI::sum(volume.energy, comm);
    report.unknowns      = unknowns.n_global();
    report.patches       = Utilities::MPI::sum(table.patches.size(), comm);
    report.lambda_iterations =
      double(Utilities::MPI::sum(table.newton_iterations, comm)) /
      Utilities::MPI::sum(table.n_particles, comm);
    report.max_lambda_iterations =
      Utilities::MPI::max(table.max_newton_iterations, comm);
  }

  template <int dim>
  void
  Stepper<dim>::start(const double t, const double dt)
  {
    const StepTime time{t - dt, newmark(dt)};
    build_supports(t, dt);
    if (!scene.inertia)
      return;
    if (scene.contact)
      remove_contact_pairs(table);
    // The residual of the state at t itself: a step that ends there, and fields
    // for which Newmark's formulas at du = 0 give no acceleration and the
    // velocity v_n.
    const Newmark &n         = time.newmark;
    const double   a_per_v   = n.alpha3 != 0. ? -n.alpha2 / n.alpha3 : 0.;
    const double   v_divisor = n.alpha5 + n.alpha6 * a_per_v;
    for (unsigned int i = 0; i < unknowns.n_owned_displacements(); ++i)
      {
        const double v              = fields.v_n.local_element(i);
        fields.x.local_element(i)   = 0.;
        fields.v_n.local_element(i) = n.alpha3 != 0. ? v / v_divisor : 0.;
        fields.a_n.local_element(i) =
          n.alpha3 != 0. ? a_per_v * fields.v_n.local_element(i) : v / n.alpha6;
      }
    for (auto *vector : {&fields.x, &fields.v_n, &fields.a_n})
      vector->update_ghost_values();
    Vector residual;
    unknowns.initialize(residual);
    assembler.assemble(table, time, fields, 1., false, residual);
    const Vector a_0 = start_acceleration(scene,
                                          terms,
                                          table,
                                          time,
                                          fields,
                                          residual,
                                          unknowns,
                                          linear_solver,
                                          log);
    set_accelerations(particles, table, unknowns, a_0);
    if (nodes)
      nodes->set_acceleration(unknowns, a_0);
  }

  template <int dim>
  std::vector<std::string>
  Stepper<dim>::term_names() const
  {
    std::vector<std::string> names;
    for (const auto &term : terms)
      names.push_back(term->name());
    return names;
  }

  template <int dim>
  std::string
  Stepper<dim>::solver_in_use(const double dt) const
  {
    const SystemTraits what = traits(newmark(dt));
    std::ostringstream out;
    out.precision(3);
    const SolverChoice choice = linear_solver.choose(unknowns, what);
    out << to_string(choice.kind) << " for " << unknowns.n_global()
        << " unknowns: " << choice.reason << " ("
        << (what.symmetric ? "symmetric" : "unsymmetric") << ", acoustic CFL "
        << what.acoustic_cfl << ")";
    return out.str();
  }

  // All but what stepper_fields.cc has.
  template class Stepper<2>;
  template class Stepper<3>;
} // namespace selkie
