#pragma once

#include <selkie/drivers/step_report.h>
#include <selkie/output/audit.h>
#include <selkie/output/statistics.h>
#include <selkie/output/verdict.h>

#include <string>
#include <vector>

namespace selkie
{
  /// Where the energy went since the start (J).
  struct Energies
  {
    double initial    = 0;
    double potential  = 0; ///< at the start
    double dissipated = 0, external_work = 0;
    double of_reset = 0, of_volume = 0; ///< given by the fluid's rules
    double of_adapting = 0;             ///< given by points split and merged

    double
    balance(const Audit &now) const
    {
      return now.energy() + dissipated - external_work - of_volume -
             of_adapting - initial;
    }

    /// What a gain or loss is measured by: all that moves or is stored, and
    /// what gravity or loads have given; 1 if there is nothing.
    double
    in_play(const Audit &now) const;
  };

  /// What the audit carries from step to step: for checkpoints.
  struct AuditState
  {
    Energies                  energies;
    std::vector<Verdict::Row> verdict;
    double                    initial_volume = 0; ///< m^dim
  };

  /**
   * The audit of a run (effect `audit`): after every step the figures of all
   * points, the balance of energy, and the verdict on them.
   */
  template <int dim>
  class RunAudit
  {
  public:
    /// At the start of the run. Collective.
    explicit RunAudit(const ParticleSet<dim> &particles);

    /// Goes on with that of an earlier part. Collective.
    RunAudit(const ParticleSet<dim> &particles, const AuditState &state);

    /// After a step that ended at time @p t (s). Collective.
    void
    record(const double t, const StepReport<dim> &report);

    /// Between two steps points were split and merged, which added so much
    /// energy (J).
    void
    book_adapting(const double energy)
    {
      energies.of_adapting += energy;
    }

    /// The figures of the step just recorded.
    void
    set_columns(const StepReport<dim> &report, Statistics &statistics) const;

    const Audit &
    figures() const
    {
      return present;
    }

    const Verdict &
    verdict() const
    {
      return judgement;
    }

    AuditState
    state() const;

    /// Two lines for the log: the balance of energy and the verdict.
    std::vector<std::string>
    text() const;

  private:
    void
    judge(const double t, const StepReport<dim> &report);

    const ParticleSet<dim> &particles;
    Audit                   present;
    Energies                energies;
    double                  initial_volume; ///< m^dim
    Verdict                 judgement;
  };
} // namespace selkie
