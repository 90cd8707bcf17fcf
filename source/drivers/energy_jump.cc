#include <selkie/base/exceptions.h>
#include <selkie/base/text.h>
#include <selkie/drivers/energy_jump.h>
#include <selkie/drivers/run_audit.h>
#include <selkie/output/audit.h>

namespace selkie
{
  template <int dim>
  void
  check_energy_jump(const PointUpdate<dim> &update,
                    const StepReport<dim>  &report,
                    const double            unbalanced)
  {
    const Audit before = audit(update.particles), after = audit(update);
    Energies    step;
    step.initial       = before.energy();
    step.potential     = before.potential;
    step.dissipated    = report.dissipated;
    step.external_work = report.external_work;
    step.of_volume     = report.volume_energy;
    const double gain  = step.balance(after);
    const double share = gain / step.in_play(after);
    const double limit = update.particles.scene.time.largest_energy_jump;
    if (share <= limit || gain <= unbalanced) // neither for what is not finite
      return;
    throw NumericalFailure(
      format("the step would gain %.3g J from nothing, %.2g of the energy in "
             "play; 'Time/Largest energy jump' allows %.2g",
             gain,
             share,
             limit));
  }


  template void
  check_energy_jump(const PointUpdate<2> &,
                    const StepReport<2> &,
                    const double);
  template void
  check_energy_jump(const PointUpdate<3> &,
                    const StepReport<3> &,
                    const double);
} // namespace selkie
