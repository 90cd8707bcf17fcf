// The rescue chain: iterative, then direct, then a typed failure, all of them
// judged by the true residual.
#include <selkie/base/exceptions.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/shape/lme_support.h>
#include <selkie/solver/direct_solver.h>
#include <selkie/solver/linear_solver.h>
#include <selkie/solver/paced_control.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "../small_scenes.h"

namespace
{
  using namespace selkie;

  /// The sparsity of a small block, with a matrix of our choice in it.
  struct Problem
  {
    explicit Problem(const std::vector<std::string> &overrides = {})
      : scene(small_scenes::read<2>(small_scenes::free_block(), overrides))
      , mesh(make_background_mesh(scene.domain, MPI_COMM_WORLD))
      , particles(scene, *mesh)
    {
      particles.seed();
      cloud      = std::make_unique<NodeCloud<2>>(*mesh,
                                             scene.lme.gamma,
                                             scene.lme.support_tolerance);
      conditions = std::make_unique<NodeConditions<2>>(scene, *cloud);
      system     = std::make_unique<System<2>>(*cloud, *conditions, false);
      SupportTable<2> table;
      const auto      occupancy = find_occupancy(particles, *cloud, false);
      fill_material_points(particles, *cloud, occupancy, table);
      system->reinit(occupancy, table);
      system->want_matrix(table);
      for (auto *vector : {&rhs, &x, &residual})
        system->initialize(*vector);
      system->matrix().clear();
      for (unsigned int i = 0; i < system->n_owned(); ++i)
        {
          rhs.local_element(i) = std::sin(1. + global(i));
          add(i, i, 2. + std::cos(3. * global(i)));
        }
    }

    dealii::types::global_dof_index
    global(const unsigned int i) const
    {
      return system->partitioner()->local_to_global(i);
    }

    /// To the row and column of owned unknowns.
    void
    add(const unsigned int i, const unsigned int j, const double value)
    {
      system->matrix().add(i, j, value);
    }

    LinearSolver<2>
    solver()
    {
      return LinearSolver<2>(scene.linear_solver,
                             [this](const std::string &text) { log = text; });
    }

    LinearSolveReport
    solve_by(LinearSolver<2> &solver)
    {
      return solver.solve({*system, traits, rhs, scene.linear_solver.tolerance},
                          x);
    }

    LinearSolveReport
    solve()
    {
      system->matrix().compress();
      auto solver = this->solver();
      return solve_by(solver);
    }

    double
    true_residual()
    {
      system->matrix().vmult(residual, x);
      residual.sadd(-1., 1., rhs);
      return residual.l2_norm() / rhs.l2_norm();
    }

    Scene<2>                                                         scene;
    std::unique_ptr<dealii::parallel::distributed::Triangulation<2>> mesh;
    ParticleSet<2>                                                   particles;
    std::unique_ptr<NodeCloud<2>>                                    cloud;
    std::unique_ptr<NodeConditions<2>>                               conditions;
    std::unique_ptr<System<2>>                                       system;
    SystemTraits                                                     traits;
    Vector                                                           rhs, x;
    Vector                                                           residual;
    std::string                                                      log;
  };

  /// Couples the components of each node by a rotation of 90 degrees: no
  /// energy in it, which stops conjugate gradients.
  void
  make_skew(Problem &problem)
  {
    problem.traits.symmetric = false;
    problem.system->matrix().clear();
    for (unsigned int i = 0; i < problem.system->n_owned(); i += 2)
      {
        problem.add(i, i + 1, 1.);
        problem.add(i + 1, i, -1.);
      }
  }
} // namespace

TEST(LinearSolverMPI, IterativeAndDirectReachTheTrueResidual)
{
  for (const std::string kind :
       {"cg jacobi", "cg ml", "minres jacobi", "direct"})
    {
      Problem problem(
        {"Linear solver/Solver=" + kind, "Linear solver/Tolerance=1e-12"});
      const auto report = problem.solve();
      EXPECT_LE(problem.true_residual(), 1e-12) << kind;
      EXPECT_NEAR(report.residual, problem.true_residual(), 1e-14) << kind;
      EXPECT_FALSE(report.fell_back) << kind << ": " << problem.log;
      EXPECT_EQ(report.iterations == 0, kind == "direct");
    }
}

TEST(LinearSolverMPI, TheDirectSolverTakesOverAndSaysSo)
{
  for (const std::string kind : {"cg jacobi", "minres jacobi"})
    {
      Problem problem({"Linear solver/Solver=" + kind});
      make_skew(problem);
      const auto report = problem.solve();
      EXPECT_LE(problem.true_residual(), 1e-8) << kind;
      EXPECT_TRUE(report.fell_back) << kind;
      EXPECT_EQ(report.solver, to_string(SolverKind::direct)) << kind;
      EXPECT_NE(problem.log.find("the direct solver takes over"),
                std::string::npos)
        << kind << ": " << problem.log;
    }
}

TEST(LinearSolverMPI, WhatFailedIsNotTriedAgainBeforeTheNextStep)
{
  Problem problem({"Linear solver/Solver=cg jacobi"});
  make_skew(problem);
  problem.system->matrix().compress();
  auto       solver = problem.solver();
  const auto solve  = [&] {
    problem.log.clear();
    const auto report = problem.solve_by(solver);
    EXPECT_LE(problem.true_residual(), 1e-8);
    EXPECT_TRUE(report.fell_back);
    return problem.log;
  };
  EXPECT_NE(solve().find("takes over for this step"), std::string::npos);
  EXPECT_EQ(solve(), ""); // straight to the direct one
  solver.forget();
  EXPECT_NE(solve().find("takes over for this step"), std::string::npos);
}

TEST(LinearSolverMPI, TooFewIterationsAreSaid)
{
  Problem problem(
    {"Linear solver/Solver=minres jacobi", "Linear solver/Iterations=1"});
  for (unsigned int i = 0; i + 2 < problem.system->n_owned(); i += 2)
    problem.add(i, i + 1, 0.9), problem.add(i + 1, i, 0.9);
  EXPECT_TRUE(problem.solve().fell_back);
  EXPECT_NE(problem.log.find("no convergence in 1 iterations"),
            std::string::npos)
    << problem.log;
}

TEST(PacedControl, EndsWhatWouldNotComeToItsEnd)
{
  using State         = dealii::SolverControl::State;
  const auto ended_at = [](const auto &residual) {
    PacedControl control(2000, 1e-8);
    unsigned int n     = 0;
    State        state = control.check(0, residual(0));
    while (state == State::iterate)
      ++n, state = control.check(n, residual(n));
    return std::make_pair(state, n);
  };
  const auto pace = [](const double share) {
    return [share](const unsigned int n) { return std::pow(share, n); };
  };
  // 1835 iterations of 1 % would do, but not 3675 of half a per cent.
  EXPECT_EQ(ended_at(pace(0.990)), std::make_pair(State::success, 1833u));
  EXPECT_EQ(ended_at(pace(0.995)), std::make_pair(State::failure, 120u));
  EXPECT_EQ(ended_at([](unsigned int) { return 1.; }).first, State::failure);
  // One that stops half way.
  EXPECT_EQ(ended_at([](const unsigned int n) {
              return std::pow(0.95, std::min(n, 150u));
            }),
            std::make_pair(State::failure, 360u));
}

TEST(LinearSolverMPI, ASingularMatrixIsATypedFailure)
{
  for (const std::string kind : {"cg jacobi", "direct"})
    {
      Problem problem({"Linear solver/Solver=" + kind});
      for (unsigned int i = 0; i < problem.system->n_owned(); ++i)
        if (problem.global(i) == 0)
          problem.add(i, i, -3.); // 2 + cos 0
      try
        {
          problem.solve();
          ADD_FAILURE() << kind << ": no failure";
        }
      catch (const LinearSolverFailure &failure)
        {
          const std::string text = failure.what();
          EXPECT_TRUE(text.find("singular") != std::string::npos ||
                      text.find("true residual") != std::string::npos)
            << text;
        }
    }
}

TEST(DirectSolverMPI, GrowsItsRoom)
{
  // 99 % less than MUMPS's estimate does not do.
  Problem problem;
  problem.system->matrix().compress();
  DirectSolver solver(0); // MUMPS on any number of ranks
  solver.factorise(problem.system->shared_matrix(), false, -99);
  solver.vmult(problem.x, problem.rhs);
  EXPECT_LE(problem.true_residual(), 1e-12);
}
