#pragma once

#include <selkie/base/log.h>
#include <selkie/base/timer_tree.h>
#include <selkie/drivers/stepper.h>

#include <vector>

namespace selkie
{
  /**
   * The text of `selkie check`: the scene's effects and terms, what a point
   * and a node carry, what ranks exchange, the solver and why it was chosen,
   * and a forecast of the run's time by phase. Collective; rank 0 writes.
   *
   * @param report of the one step that was made to find out
   * @param before,after rows of the timer tree around that step
   */
  template <int dim>
  void
  describe_plan(const Scene<dim>                  &scene,
                const ParticleSet<dim>            &particles,
                const Stepper<dim>                &stepper,
                const StepReport<dim>             &report,
                const std::vector<TimerTree::Row> &before,
                const std::vector<TimerTree::Row> &after,
                Log                               &log);
} // namespace selkie
