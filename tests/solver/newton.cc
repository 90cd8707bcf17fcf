#include <selkie/base/exceptions.h>
#include <selkie/solver/newton.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace selkie;

  /// x^3 = 8 in one unknown, in units of a tolerance.
  NewtonProblem
  cube_root(const double tolerance)
  {
    NewtonProblem problem;
    problem.residual = [](Vector &x, Vector &r) {
      r.local_element(0) = std::pow(x.local_element(0), 3) - 8.;
    };
    problem.solve = [](Vector &x, const Vector &r, Vector &dx, const double) {
      dx.local_element(0) =
        -r.local_element(0) / (3. * std::pow(x.local_element(0), 2));
      return 1u;
    };
    problem.error = [tolerance](const Vector &r) {
      return std::abs(r.local_element(0)) / tolerance;
    };
    problem.step_size = [](const Vector &) { return 0.5; };
    return problem;
  }

  Vector
  start(const double value)
  {
    Vector           x;
    dealii::IndexSet one(1);
    one.add_index(0);
    // One unknown on each rank by itself: no communication.
    x.reinit(one, MPI_COMM_SELF);
    x.local_element(0) = value;
    return x;
  }
} // namespace

TEST(Newton, ConvergesQuadratically)
{
  Vector     x = start(3.);
  const auto result =
    newton(cube_root(1e-12), NewtonParameters(), ForcingTerms(), x);
  EXPECT_NEAR(x.local_element(0), 2., 1e-13);
  const auto &e = result.errors;
  ASSERT_GE(e.size(), 4u);
  // e_{k+1} = C e_k^2: the exponent seen from the last three errors above
  // round-off.
  const std::size_t n = e.size() - 2;
  const double      order =
    std::log(e[n] / e[n - 1]) / std::log(e[n - 1] / e[n - 2]);
  EXPECT_GT(order, 1.8);
}

TEST(Newton, NeverPassesSilently)
{
  Vector           x = start(3.);
  NewtonParameters parameters;
  parameters.max_iterations = 3;
  EXPECT_THROW(newton(cube_root(1e-12), parameters, ForcingTerms(), x),
               NewtonFailure);
}

TEST(Newton, RefusesNumbersThatAreNotFinite)
{
  Vector        x       = start(3.);
  NewtonProblem problem = cube_root(1e-12);
  problem.residual      = [](Vector &, Vector &r) {
    r.local_element(0) = std::nan("");
  };
  EXPECT_THROW(newton(problem, NewtonParameters(), ForcingTerms(), x),
               NewtonFailure);
}

namespace
{
  std::string
  failure_of(const NewtonProblem &problem, const NewtonParameters &parameters)
  {
    Vector x = start(3.);
    try
      {
        newton(problem, parameters, ForcingTerms(), x);
      }
    catch (const NewtonFailure &failure)
      {
        return failure.what();
      }
    return "";
  }
} // namespace

TEST(Newton, StopsWhereItStagnatesAndSaysWhere)
{
  // A residual that a round-off of 5 tolerances keeps from vanishing.
  NewtonProblem problem = cube_root(1e-6);
  problem.residual      = [calls = 0](Vector &x, Vector &r) mutable {
    r.local_element(0) =
      std::pow(x.local_element(0), 3) - 8. + (++calls % 2 == 0 ? 5e-6 : -5e-6);
  };
  problem.describe = [](const Vector &) { return "HERE"; };
  NewtonParameters parameters;
  parameters.max_iterations = 1000;
  const std::string failure = failure_of(problem, parameters);
  EXPECT_NE(failure.find("stagnates after"), std::string::npos) << failure;
  EXPECT_NE(failure.find("HERE. Try a larger Newton/Tolerance"),
            std::string::npos)
    << failure;
}

TEST(Newton, SlowProgressIsNoStagnation)
{
  // Steps of a third: a factor 1.5 each.
  NewtonProblem problem = cube_root(1e-6);
  problem.solve = [](Vector &x, const Vector &r, Vector &dx, const double) {
    dx.local_element(0) =
      -r.local_element(0) / (9. * std::pow(x.local_element(0), 2));
    return 1u;
  };
  NewtonParameters parameters;
  parameters.max_iterations = 100;
  EXPECT_EQ(failure_of(problem, parameters), "");
}
