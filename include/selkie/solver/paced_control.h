#pragma once

#include <deal.II/lac/solver_control.h>

#include <cmath>
#include <limits>

namespace selkie
{
  /// Ends a solver that would not come to its tolerance in the iterations that
  /// it is allowed, at the pace of the last 120. For residuals that do not
  /// grow, as those of GMRES.
  class PacedControl : public dealii::SolverControl
  {
  public:
    using SolverControl::SolverControl;

    /// Iterations after which it looks at the pace: two restarts of GMRES.
    static constexpr unsigned int pace = 120;

    State
    check(const unsigned int step, const double residual) override
    {
      const State state = SolverControl::check(step, residual);
      if (state != iterate || (step > 0 && step < paced_step + pace))
        return state;
      const bool too_slow =
        step > 0 && iterations_missing(step, residual) > maxsteps - step;
      paced_step     = step;
      paced_residual = residual;
      return too_slow ? failure : state;
    }

  private:
    double
    iterations_missing(const unsigned int step, const double residual) const
    {
      const double gained = std::log(paced_residual / residual);
      return gained > 0.
               ? (step - paced_step) * std::log(residual / tol) / gained
               : std::numeric_limits<double>::infinity();
    }

    unsigned int paced_step     = 0;
    double       paced_residual = 0.;
  };
} // namespace selkie
