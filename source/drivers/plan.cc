#include <selkie/base/text.h>
#include <selkie/drivers/plan.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    void
    describe_points(const ParticleFields    &fields,
                    const unsigned long long n_points,
                    Log                     &log)
    {
      std::vector<std::string> columns;
      for (const auto &entry : fields.entries())
        columns.push_back(entry.name + " (" +
                          std::to_string(8 * entry.n_components) + " B)");
      log.line("Columns   " + join(columns));
      log.line(format("Points    %llu, %u bytes of columns each",
                      n_points,
                      8 * fields.n_components()));
    }

    template <int dim>
    void
    describe_unknowns(const Scene<dim>      &scene,
                      const Stepper<dim>    &stepper,
                      const StepReport<dim> &report,
                      Log                   &log)
    {
      const double nonzeros = stepper.system().n_nonzero_elements();
      log.line(
        format("Unknowns  %llu at the start, %u a node%s",
               report.unknowns,
               dim,
               !scene.mixed_solids
                 ? scene.has_fluid() ? " and one pressure in the fluid" : ""
               : scene.has_fluid()
                 ? " and one pressure in the fluid and in mixed solids"
                 : " and one pressure in mixed solids"));
      if (const auto *points = stepper.system().points())
        log.line(format("Matrix    none; the tangent at the points takes %.1f "
                        "MB on this rank",
                        1e-6 * points->memory_consumption()));
      else
        log.line(
          format("Matrix    %.0f non-zeros, %.1f MB, %.0f bytes an unknown",
                 nonzeros,
                 12e-6 * nonzeros,
                 12. * nonzeros / report.unknowns));
    }

    /// What one update of a nodal vector moves between the ranks.
    template <int dim>
    void
    describe_exchange(const ParticleSet<dim> &particles,
                      const Stepper<dim>     &stepper,
                      Log                    &log)
    {
      const auto    &partition = *stepper.system().partitioner();
      const MPI_Comm comm      = particles.communicator();
      const unsigned n         = Utilities::MPI::n_mpi_processes(comm);
      const unsigned ghosts =
        Utilities::MPI::max(partition.n_ghost_indices(), comm);
      const unsigned neighbours = Utilities::MPI::max(
        static_cast<unsigned int>(partition.ghost_targets().size()), comm);
      log.line(n == 1
                 ? std::string("Exchange  none: one rank")
                 : format("Exchange  at most %u unknowns (%.1f kB) from "
                          "%u ranks for every nodal vector; %u bytes for "
                          "a point that changes its rank",
                          ghosts,
                          8e-3 * ghosts,
                          neighbours,
                          8 * (particles.fields.n_components() + dim + 1)));
    }

    /// The share that each section has in the steps between, by its path.
    std::vector<std::pair<std::string, double>>
    phases(const std::vector<TimerTree::Row> &before,
           const std::vector<TimerTree::Row> &after)
    {
      std::map<std::string, double> earlier;
      for (const auto &row : before)
        earlier[row.path] = row.wall;
      std::vector<std::pair<std::string, double>> result;
      double                                      total = 0.;
      for (const auto &row : after)
        if (row.depth > 0 && row.path != "other")
          {
            result.emplace_back(row.path, row.wall - earlier[row.path]);
            total += row.depth == 1 ? result.back().second : 0.;
          }
      for (auto &phase : result)
        phase.second /= total;
      return result;
    }
  } // namespace


  template <int dim>
  void
  describe_plan(const Scene<dim>       &scene,
                const ParticleSet<dim> &particles,
                const Stepper<dim>     &stepper,
                const Rehearsal<dim>   &rehearsal,
                Log                    &log)
  {
    log.line("Scene     " + scene.title + " (" + scene.file + ")");
    log.line("Effects   " + join(scene.effect_names()));
    log.line("Terms     " + join(stepper.term_names()));
    describe_points(particles.fields,
                    particles.handler().n_global_particles(),
                    log);
    describe_unknowns(scene, stepper, rehearsal.report, log);
    describe_exchange(particles, stepper, log);
    log.line("Solver    " + stepper.solver_in_use(scene.time.step));
    Utilities::System::MemoryStats memory;
    Utilities::System::get_memory_stats(memory);
    log.line(
      format("Memory    %.0f MB peak on this rank", memory.VmHWM / 1024.));

    const Forecast &forecast = rehearsal.forecast;
    log.line(format("Time      %s for the set-up (%.2g s) and %.0f steps, as "
                    "the first ones are (%.2g s each) and later ones of other "
                    "runs were (%.0f %% more)",
                    time_span(rehearsal.set_up + forecast.total()).c_str(),
                    rehearsal.set_up,
                    forecast.steps(),
                    forecast.step(),
                    100. * (forecast.growth() - 1.)));
    for (const auto &[path, share] : phases(rehearsal.before, rehearsal.after))
      if (share > 1e-3)
        log.line(format("          %-22s %s",
                        path.c_str(),
                        time_span(share * forecast.total()).c_str()));
  }

#define INSTANTIATE(dim)                                \
  template void describe_plan(const Scene<dim> &,       \
                              const ParticleSet<dim> &, \
                              const Stepper<dim> &,     \
                              const Rehearsal<dim> &,   \
                              Log &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
