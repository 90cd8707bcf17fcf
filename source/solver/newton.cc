#include <selkie/base/exceptions.h>
#include <selkie/solver/newton.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  namespace
  {
    std::string
    history(const std::vector<double> &errors)
    {
      std::ostringstream out;
      out.precision(2);
      for (const double error : errors)
        out << ' ' << error;
      return out.str();
    }

    /// Whether the last iterations together have not halved the smallest
    /// residual of those before. The first guess does not count: its residual
    /// may be small by chance.
    bool
    stagnates(const std::vector<double> &errors)
    {
      constexpr unsigned int window = 8;
      if (errors.size() < window + 2)
        return false;
      const auto recent = errors.end() - window;
      return *std::min_element(recent, errors.end()) >
             0.5 * *std::min_element(errors.begin() + 1, recent);
    }

    [[noreturn]] void
    fail(const std::string         &why,
         const std::string         &what_to_try,
         const NewtonProblem       &problem,
         const std::vector<double> &errors,
         const Vector              &residual)
    {
      std::string text = "Newton's iteration " + why +
                         "; the residual in units of its tolerance went" +
                         history(errors) + ". ";
      if (problem.describe)
        text += problem.describe(residual) + ". ";
      throw NewtonFailure(text + "Try " + what_to_try + ".");
    }
  } // namespace

  double
  ForcingTerms::tolerance(const double error, const double previous) const
  {
    const double needed = 0.1 / error;
    const double hoped =
      previous > 0. ? 0.1 * std::pow(error / previous, 2) : loosest;
    return std::clamp(std::max(needed, std::min(hoped, loosest)),
                      tightest,
                      std::max(tightest, loosest));
  }


  NewtonResult
  newton(const NewtonProblem    &problem,
         const NewtonParameters &parameters,
         const ForcingTerms     &forcing,
         Vector                 &x)
  {
    constexpr unsigned int max_halvings = 6;

    NewtonResult result;
    Vector       residual(x), dx(x), x_old(x);
    problem.residual(x, residual);
    double error = problem.error(residual), previous = 0.;
    result.errors.push_back(error);

    while (result.iterations < parameters.max_iterations)
      {
        ++result.iterations;
        result.linear_iterations +=
          problem.solve(x, residual, dx, forcing.tolerance(error, previous));
        previous          = error;
        const double size = problem.step_size(dx);
        if (!std::isfinite(size))
          throw NewtonFailure("the linear solver returned a step that is not "
                              "finite");
        if (size > 1.)
          dx *= 1. / size;

        x_old.copy_locally_owned_data_from(x);
        double       fraction = 1.;
        unsigned int halvings = 0;
        for (;; fraction *= 0.5, ++halvings)
          {
            bool inverted = false;
            x.zero_out_ghost_values();
            x.copy_locally_owned_data_from(x_old);
            x.add(fraction, dx);
            try
              {
                problem.residual(x, residual);
              }
            catch (const InvertedPoint &)
              {
                if (halvings == max_halvings)
                  throw;
                inverted = true;
              }
            if (inverted)
              continue;
            const double trial = problem.error(residual);
            // A predictor may sit at a deceptively small residual: the first
            // step may raise it; later ones may not.
            const double bound = result.iterations == 1 ? 1e3 : 2.;
            if (trial <= 1. || trial < bound * error ||
                !parameters.line_search || halvings == max_halvings)
              {
                error = trial;
                break;
              }
          }
        result.errors.push_back(error);
        const std::string made =
          std::to_string(result.iterations) + " iterations";
        if (!std::isfinite(error))
          fail("met a residual that is not finite after " + made,
               "a smaller Time/Step",
               problem,
               result.errors,
               residual);
        if (error <= 1.)
          return result;
        if (stagnates(result.errors))
          fail("stagnates after " + made,
               error < 100. ? "a larger Newton/Tolerance: this is near "
                              "round-off"
                            : "a smaller Time/Step",
               problem,
               result.errors,
               residual);
      }
    fail("did not converge in " + std::to_string(result.iterations) +
           " iterations",
         "a smaller Time/Step or more Newton/Iterations",
         problem,
         result.errors,
         residual);
  }
} // namespace selkie
