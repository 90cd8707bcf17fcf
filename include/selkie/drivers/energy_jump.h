#pragma once

#include <selkie/drivers/step_report.h>
#include <selkie/transfer/transfer.h>

namespace selkie
{
  /**
   * Refuses a step that would gain energy from nothing: the points' energy
   * balance (Energies, run_audit.h) of the step alone, before it is written.
   * What a step loses is the scheme's damping and no reason to refuse it.
   * Collective.
   * @param report dissipation and works of the step
   * @param unbalanced work that Newton's tolerance leaves unexplained (J)
   * @throw NumericalFailure, on all ranks, beyond 'Time/Largest energy jump'.
   */
  template <int dim>
  void
  check_energy_jump(const PointUpdate<dim> &update,
                    const StepReport<dim>  &report,
                    const double            unbalanced);
} // namespace selkie
