#pragma once

#include <selkie/base/log.h>
#include <selkie/base/timer_tree.h>
#include <selkie/drivers/forecast.h>
#include <selkie/drivers/stepper.h>

#include <vector>

namespace selkie
{
  /// The first steps of a run, made to find out what it costs.
  template <int dim>
  struct Rehearsal
  {
    double                      set_up; ///< wall time before the steps (s)
    StepReport<dim>             report; ///< of the last step
    Forecast                    forecast;
    std::vector<TimerTree::Row> before, after; ///< after the cold steps
  };

  /**
   * The text of `selkie check`: the scene's effects and terms, what a point
   * and a node carry, what ranks exchange, the solver and why it was chosen,
   * and a forecast of the run's time by phase. Collective; rank 0 writes.
   */
  template <int dim>
  void
  describe_plan(const Scene<dim>       &scene,
                const ParticleSet<dim> &particles,
                const Stepper<dim>     &stepper,
                const Rehearsal<dim>   &rehearsal,
                Log                    &log);
} // namespace selkie
