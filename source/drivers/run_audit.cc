#include <selkie/base/text.h>
#include <selkie/drivers/run_audit.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  double
  Energies::in_play(const Audit &now) const
  {
    const double sum = std::max(now.kinetic + now.strain + now.compression,
                                initial - potential) +
                       std::abs(now.potential - potential) +
                       std::abs(external_work);
    return sum > 0. ? sum : 1.;
  }


  template <int dim>
  RunAudit<dim>::RunAudit(const ParticleSet<dim> &particles)
    : particles(particles)
    , present(audit(particles))
    , initial_volume(present.volume)
  {
    energies.initial   = present.energy();
    energies.potential = present.potential;
  }


  template <int dim>
  RunAudit<dim>::RunAudit(const ParticleSet<dim> &particles,
                          const AuditState       &state)
    : particles(particles)
    , present(audit(particles))
    , energies(state.energies)
    , initial_volume(state.initial_volume)
  {
    judgement.restore(state.verdict);
  }


  template <int dim>
  AuditState
  RunAudit<dim>::state() const
  {
    return {energies, judgement.rows(), initial_volume};
  }


  template <int dim>
  void
  RunAudit<dim>::record(const double t, const StepReport<dim> &report)
  {
    energies.dissipated += report.dissipated;
    energies.external_work += report.external_work;
    energies.of_reset += report.reset_energy;
    energies.of_volume += report.volume_energy;
    present = audit(particles);
    judge(t, report);
  }


  /// Holds the figures of the step against the scene's limits.
  template <int dim>
  void
  RunAudit<dim>::judge(const double t, const StepReport<dim> &report)
  {
    const Scene<dim>  &scene  = particles.scene;
    const AuditLimits &limits = *scene.audit;
    const auto        &points = particles.accounting;
    const double       scale  = energies.in_play(present);
    const auto         change = [](const double now, const double before) {
      return std::abs(now - before) / before;
    };
    judgement.look("energy gain",
                   energies.balance(present) / scale,
                   limits.energy_gain,
                   t);
    judgement.look("mass change",
                   change(present.mass + points.removed_mass,
                          points.seeded_mass),
                   limits.mass,
                   t);
    if (!scene.has_solid() && points.removed == 0)
      judgement.look("volume change",
                     change(present.volume, initial_volume),
                     limits.volume,
                     t);
    judgement.look("smallest J", present.min_J, limits.smallest_J, t, true);
    if (scene.inertia && !scene.lagrangian_mesh())
      judgement.look("unseen energy",
                     (present.kinetic - report.kinetic) / scale,
                     limits.unseen_energy,
                     t);
    if (scene.has_pressure())
      judgement.look("checkerboard",
                     report.checkerboard,
                     limits.checkerboard,
                     t);
  }


  template <int dim>
  void
  RunAudit<dim>::set_columns(const StepReport<dim> &report,
                             Statistics            &statistics) const
  {
    const Scene<dim> &scene = particles.scene;
    selkie::set_columns(present, particles, statistics);
    const std::string energy = dim == 2 ? " (J/m)" : " (J)";
    if (scene.inertia)
      {
        statistics.set("nodes' kinetic energy" + energy, report.kinetic);
        statistics.set(dim == 2 ? "smallest node mass (kg/m)"
                                : "smallest node mass (kg)",
                       report.smallest_node_mass);
      }
    if (scene.has_pressure())
      statistics.set("pressure checkerboard", report.checkerboard);
    statistics.set("dissipated energy" + energy, energies.dissipated);
    statistics.set("external work" + energy, energies.external_work);
    if (scene.has_fluid())
      {
        statistics.set("energy of J reset" + energy, energies.of_reset);
        if (scene.corrects_volume())
          statistics.set("energy of volume correction" + energy,
                         energies.of_volume);
      }
    if (scene.adaptivity)
      statistics.set("energy of adapting" + energy, energies.of_adapting);
    statistics.set("energy balance" + energy, energies.balance(present));
  }


  template <int dim>
  std::vector<std::string>
  RunAudit<dim>::text() const
  {
    const double balance = energies.balance(present);
    return {format("Energy    balance %.3g J (%.2g of the energy in play)",
                   balance,
                   balance / energies.in_play(present)),
            "Audit     " + judgement.text()};
  }

  template class RunAudit<2>;
  template class RunAudit<3>;
} // namespace selkie
