#pragma once

#include <selkie/base/types.h>
#include <selkie/scene/scene.h>

#include <functional>
#include <string>
#include <vector>

namespace selkie
{
  /// What Newton's method needs of an equation R(x) = 0.
  struct NewtonProblem
  {
    /// R at x. May throw InvertedPoint (on every rank).
    std::function<void(Vector &x, Vector &residual)> residual;

    /// Solves K(x) dx = -residual to a relative residual; returns the linear
    /// iterations.
    std::function<unsigned int(Vector       &x,
                               const Vector &residual,
                               Vector       &dx,
                               const double  tolerance)>
      solve;

    /// Size of a residual in units of its tolerance: converged when <= 1.
    std::function<double(const Vector &residual)> error;

    /// Largest |dx| allowed relative to its limit: dx is scaled down to 1.
    std::function<double(const Vector &dx)> step_size;

    /// Says where a residual is largest, for the message of a failure; may be
    /// missing. Collective.
    std::function<std::string(const Vector &residual)> describe;
  };

  /// How well Newton's method wants its linear systems solved.
  struct ForcingTerms
  {
    double tightest = 1e-8, loosest = 1e-4; ///< relative residuals

    /// For an iterate whose error is @p error tolerances, the one before it
    /// @p previous (0: none). The last iterations are not solved better than
    /// convergence needs, the others not better than the quadratic convergence
    /// from one to the next lets hope (Eisenstat & Walker 1996, choice 2).
    double
    tolerance(const double error, const double previous) const;
  };

  struct NewtonResult
  {
    unsigned int        iterations = 0, linear_iterations = 0;
    std::vector<double> errors; ///< of the iterates, in units of the tolerance
  };

  /**
   * Newton's method with a line search by halving. At least one iteration is
   * made. Throws NewtonFailure, with the history of the residual, where it is
   * largest and what to try, when max_iterations do not suffice, when several
   * iterations together do not halve the residual (it stagnates), when it is
   * not finite, or when no fraction of a step can be evaluated.
   */
  NewtonResult
  newton(const NewtonProblem    &problem,
         const NewtonParameters &parameters,
         const ForcingTerms     &forcing,
         Vector                 &x);
} // namespace selkie
