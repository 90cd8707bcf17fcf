// Whole steps: Newton's order on the assembled system, and failed steps that
// leave no trace.
#include <selkie/base/exceptions.h>
#include <selkie/drivers/stepper.h>
#include <selkie/mesh/background_mesh.h>

#include <gtest/gtest.h>

#include <cmath>

#include "../small_scenes.h"

namespace
{
  using namespace selkie;

  struct Scenario
  {
    Scenario(const std::string &text, const std::vector<std::string> &overrides)
      : scene(small_scenes::read<2>(text, overrides))
      , mesh(make_background_mesh(scene.domain, MPI_COMM_WORLD))
      , particles(scene, *mesh)
      , timers(MPI_COMM_WORLD)
    {
      particles.seed();
      cloud   = std::make_unique<NodeCloud<2>>(*mesh,
                                             scene.lme.gamma,
                                             scene.lme.support_tolerance);
      stepper = std::make_unique<Stepper<2>>(
        scene, particles, *cloud, timers, [](const std::string &) {});
      stepper->start(0., scene.time.step);
    }

    Scene<2>                                                         scene;
    std::unique_ptr<dealii::parallel::distributed::Triangulation<2>> mesh;
    ParticleSet<2>                                                   particles;
    TimerTree                                                        timers;
    std::unique_ptr<NodeCloud<2>>                                    cloud;
    std::unique_ptr<Stepper<2>>                                      stepper;
  };

  /// The exponent p of e_{k+1} ~ e_k^p, from the last three errors of which
  /// the last is above round-off.
  double
  observed_order(const std::vector<double> &errors)
  {
    std::size_t last = errors.size() - 1;
    while (last > 2 && errors[last] < 1e-1)
      --last;
    return std::log(errors[last] / errors[last - 1]) /
           std::log(errors[last - 1] / errors[last - 2]);
  }
} // namespace

TEST(Stepper, NewtonIsQuadraticForASolid)
{
  // A block that is stretched and sheared by tens of percent in one step.
  Scenario   run(small_scenes::free_block(),
               {"Bodies/block/Initial velocity=8*(x-0.5); 6*x*y",
                  "Newton/Tolerance=1e-12",
                  "Linear solver/Solver=direct",
                  "Time/Step=2e-2"});
  const auto report = run.stepper->step(0., 2e-2);
  ASSERT_GE(report.newton.errors.size(), 4u);
  EXPECT_GT(observed_order(report.newton.errors), 1.8);
}

TEST(Stepper, NewtonIsQuadraticForFluidAndSolid)
{
  Scenario   run(small_scenes::fluid_on_solid(),
               {"Newton/Tolerance=1e-12",
                  "Linear solver/Solver=direct",
                  "Bodies/water/Initial velocity=8*y*x; 6*x",
                  "Bodies/bed/Initial velocity=8*y*x; 6*x"});
  const auto report = run.stepper->step(0., 5e-3);
  ASSERT_GE(report.newton.errors.size(), 4u);
  EXPECT_GT(observed_order(report.newton.errors), 1.8);
}

TEST(Stepper, SolversFollowAChangedPattern)
{
  // The block flies over some cells; what MUMPS and ML keep of a matrix must
  // not outlive its pattern.
  for (const std::string solver : {"direct", "cg ml"})
    {
      Scenario run(small_scenes::free_block(),
                   {"Bodies/block/Initial velocity=3; 0",
                    "Linear solver/Solver=" + solver});
      for (unsigned int n = 0; n < 6; ++n)
        run.stepper->step(n * 1e-2, 1e-2);
      EXPECT_GT(run.stepper->system().n_sparsity_builds(), 1u) << solver;
      for (const auto &point : run.particles.handler())
        EXPECT_NEAR(run.particles.columns.v(point.get_properties())[0],
                    3.,
                    1e-8)
          << solver;
    }
}

TEST(Stepper, AFailedStepLeavesNoTrace)
{
  Scenario run(small_scenes::fluid_on_solid(), {"Newton/Iterations=1"});
  std::vector<dealii::Point<2>> before;
  std::vector<double>           properties;
  for (const auto &point : run.particles.handler())
    {
      before.push_back(point.get_location());
      for (const double value : point.get_properties())
        properties.push_back(value);
    }
  EXPECT_THROW(run.stepper->step(0., 2e-3), NewtonFailure);
  unsigned int i = 0, k = 0;
  for (const auto &point : run.particles.handler())
    {
      EXPECT_EQ(point.get_location(), before[i++]);
      for (const double value : point.get_properties())
        EXPECT_EQ(value, properties[k++]);
    }
  EXPECT_EQ(i, before.size());
}
