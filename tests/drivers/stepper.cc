// Whole steps: Newton's order on the assembled system, and failed steps that
// leave no trace.
#include <selkie/base/exceptions.h>
#include <selkie/drivers/stepper.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/output/audit.h>

#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <map>
#include <sstream>

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
      if (scene.approximation == Approximation::lme_mpm)
        cloud = std::make_unique<NodeCloud<2>>(*mesh,
                                               scene.lme.gamma,
                                               scene.lme.support_tolerance);
      else
        cloud = std::make_unique<NodeCloud<2>>(*mesh);
      stepper = std::make_unique<Stepper<2>>(
        scene, particles, *cloud, timers, [this](const std::string &line) {
          said += line + '\n';
        });
      stepper->start(0., scene.time.step);
    }

    Scene<2>                                                         scene;
    std::unique_ptr<dealii::parallel::distributed::Triangulation<2>> mesh;
    ParticleSet<2>                                                   particles;
    TimerTree                                                        timers;
    std::unique_ptr<NodeCloud<2>>                                    cloud;
    std::unique_ptr<Stepper<2>>                                      stepper;
    std::string                                                      said;
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

TEST(Stepper, NewtonIsQuadraticForFiniteElements)
{
  // The same, and with the mean dilatation of a nearly incompressible solid.
  for (const std::string cure : {"", ", mean dilatation"})
    {
      Scenario   run(small_scenes::free_block(),
                   {"Approximation=q4 fem",
                      "Effects=inertia" + cure,
                      "Bodies/block/Law parameters/Poisson ratio=" +
                        std::string(cure.empty() ? "0.3" : "0.49"),
                      "Bodies/block/Initial velocity=8*(x-0.5); 6*x*y",
                      "Newton/Tolerance=1e-12",
                      "Linear solver/Solver=direct",
                      "Time/Step=2e-2"});
      const auto report = run.stepper->step(0., 2e-2);
      ASSERT_GE(report.newton.errors.size(), 4u);
      EXPECT_GT(observed_order(report.newton.errors), 1.8) << cure;
    }
}

TEST(Stepper, NewtonIsQuadraticForFluidAndSolid)
{
  for (const std::string approximation : {"lme mpm", "q4 fem"})
    {
      Scenario   run(small_scenes::fluid_on_solid(),
                   {"Approximation=" + approximation,
                      "Newton/Tolerance=1e-12",
                      "Linear solver/Solver=direct",
                      "Bodies/water/Initial velocity=8*y*x; 6*x",
                      "Bodies/bed/Initial velocity=8*y*x; 6*x"});
      const auto report = run.stepper->step(0., 5e-3);
      ASSERT_GE(report.newton.errors.size(), 4u);
      EXPECT_GT(observed_order(report.newton.errors), 1.8) << approximation;
    }
}

TEST(Stepper, NewtonIsQuadraticForFluidAndMixedSolid)
{
  for (const std::string approximation : {"lme mpm", "q4 fem"})
    {
      Scenario   run(small_scenes::water_on_rubber(2),
                   {"Approximation=" + approximation,
                      "Newton/Tolerance=1e-12",
                      "Linear solver/Solver=direct",
                      "Bodies/water/Initial velocity=8*y*x; 6*x",
                      "Bodies/rubber/Initial velocity=8*y*x; 6*x",
                      "Bodies/steel/Initial velocity=8*y*x; 6*x"});
      const auto report = run.stepper->step(0., 5e-3);
      ASSERT_GE(report.newton.errors.size(), 4u);
      EXPECT_GT(observed_order(report.newton.errors), 1.8) << approximation;
    }
}

TEST(Stepper, StartsWithTheAccelerationOfTheLoadsAtTheStart)
{
  Scenario run(small_scenes::free_block(),
               {"Effects=inertia, body force",
                "Bodies/block/Initial velocity=0; 0",
                "Body force/Acceleration=3 + 1000*t; 0"});
  for (const auto &point : run.particles.handler())
    EXPECT_NEAR(run.particles.columns.a(point.get_properties())[0], 3., 1e-12);
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
      EXPECT_GT(run.stepper->system().n_structures(), 1u) << solver;
      for (const auto &point : run.particles.handler())
        EXPECT_NEAR(run.particles.columns.v(point.get_properties())[0],
                    3.,
                    1e-8)
          << solver;
    }
}

namespace
{
  /// A step that fails with an Error whose message says so, and what it leaves.
  template <typename Error>
  void
  expect_failure_without_trace(Scenario          &run,
                               const double       t,
                               const double       dt,
                               const std::string &says)
  {
    std::vector<dealii::Point<2>> before;
    std::vector<double>           properties;
    for (const auto &point : run.particles.handler())
      {
        before.push_back(point.get_location());
        for (const double value : point.get_properties())
          properties.push_back(value);
      }
    try
      {
        run.stepper->step(t, dt);
        ADD_FAILURE() << "the step did not fail";
      }
    catch (const Error &error)
      {
        EXPECT_NE(std::string(error.what()).find(says), std::string::npos)
          << error.what();
      }
    unsigned int i = 0, k = 0;
    for (const auto &point : run.particles.handler())
      {
        EXPECT_EQ(point.get_location(), before[i++]);
        for (const double value : point.get_properties())
          EXPECT_EQ(value, properties[k++]);
      }
    EXPECT_EQ(i, before.size());
  }

  /// Energy of all points.
  double
  energy(const Scenario &run)
  {
    return audit(run.particles).energy();
  }
} // namespace

TEST(Stepper, AFailedStepLeavesNoTrace)
{
  Scenario run(small_scenes::fluid_on_solid(), {"Newton/Iterations=1"});
  expect_failure_without_trace<NewtonFailure>(run,
                                              0.,
                                              2e-3,
                                              "did not converge");
}

TEST(Stepper, AnInvertedPointLeavesNoTrace)
{
  Scenario run(small_scenes::fluid_on_solid(),
               {"Bodies/water/Initial velocity=0; -1e3*y"});
  expect_failure_without_trace<InvertedPoint>(run, 0., 1., "inside out");
}

TEST(Stepper, ALoadThatIsNoNumberLeavesNoTrace)
{
  Scenario run(small_scenes::free_block(),
               {"Effects=inertia, body force",
                "Body force/Acceleration=sqrt(1e-3-t); 0"});
  expect_failure_without_trace<NumericalFailure>(run, 0., 2e-3, "not finite");
}

namespace
{
  constexpr double long_step = 0.08; // s

  /// A block that spins in steps so long that the trapezoidal rule, which keeps
  /// the energy of linear bodies only, takes some in the first, which is done,
  /// and adds some in the second.
  std::unique_ptr<Scenario>
  spinning_block(const double largest_jump)
  {
    std::ostringstream setting;
    setting << std::setprecision(17)
            << "Time/Largest energy jump=" << largest_jump;
    auto run = std::make_unique<Scenario>(
      small_scenes::free_block(),
      std::vector<std::string>{
        "Approximation=q4 fem",
        "Bodies/block/Initial velocity=10*(0.5-y); 10*(x-0.5)",
        setting.str()});
    run->stepper->step(0., long_step);
    return run;
  }
} // namespace

TEST(Stepper, AStepThatMakesEnergyLeavesNoTrace)
{
  const auto   free   = spinning_block(0.);
  const double before = energy(*free);
  free->stepper->step(long_step, long_step);
  const double after = energy(*free);
  const double share = (after - before) / after;
  ASSERT_GT(share, 0.1);

  const auto below = spinning_block(1.001 * share);
  below->stepper->step(long_step, long_step);
  EXPECT_EQ(energy(*below), after);

  const auto above = spinning_block(0.999 * share);
  expect_failure_without_trace<NumericalFailure>(*above,
                                                 long_step,
                                                 long_step,
                                                 "from nothing");
  above->stepper->step(long_step, long_step / 4);
  EXPECT_LT(energy(*above) / before - 1., share);
}

namespace
{
  /// A bar in a body force that grows from its held end: both masses carry it
  /// at the points, but only the consistent one gives a_0 = b exactly, as an
  /// affine field is reproduced by the functions.
  double
  worst_start_acceleration(const std::vector<std::string> &overrides)
  {
    std::vector<std::string> settings = {
      "Effects=inertia, body force",
      "Body force/Acceleration=3*(x-0.3); 0",
      "Linear solver/Tolerance=1e-12",
      "Node sets/Names=end",
      "Node sets/end/Shape=box(0.2999, 0.2999, 0.3001, 0.7001)"};
    settings.insert(settings.end(), overrides.begin(), overrides.end());
    const Scenario run(small_scenes::free_block(), settings);
    const auto    &columns = run.particles.columns;
    double         worst   = 0.;
    for (const auto &point : run.particles.handler())
      {
        auto a = columns.a(point.get_properties());
        a[0] -= 3. * (point.get_location()[0] - 0.3);
        worst = std::max(worst, a.norm());
      }
    return worst / 1.2; // b at the free end
  }
} // namespace

TEST(Stepper, ConsistentMassStartsWithTheExactAcceleration)
{
  EXPECT_LT(worst_start_acceleration({"Inertia/Mass=consistent"}), 1e-10);
  // The lumped mass smooths it at the bar's ends.
  EXPECT_GT(worst_start_acceleration({"Inertia/Mass=lumped"}), 1e-3);
}

TEST(Stepper, FewerPointsThanNodesStartWithTheLumpedMass)
{
  // Viscous stresses, which no acceleration of the points alone balances.
  Scenario run(small_scenes::fluid_on_solid(),
               {"Inertia/Mass=consistent",
                "Bodies/water/Points per direction=1",
                "Bodies/bed/Points per direction=1"});
  EXPECT_NE(run.said.find("lumped mass"), std::string::npos) << run.said;
  for (const auto &point : run.particles.handler())
    EXPECT_LT(run.particles.columns.a(point.get_properties()).norm(), 100.);
  EXPECT_NO_THROW(run.stepper->step(0., 2e-3));
}

namespace
{
  struct Transferred
  {
    double error;    ///< of the points' velocity, rms over the largest
    double momentum; ///< change, relative
  };

  /// Sends a bent velocity field to the nodes and back (PIC) in a step so short
  /// that nothing else happens.
  Transferred
  there_and_back(const std::vector<std::string> &overrides)
  {
    std::vector<std::string> settings = {
      "Bodies/block/Initial velocity=0.1*cos(pi*(x-0.3)/0.4); 0.05",
      "Transfer/FLIP fraction=0"};
    settings.insert(settings.end(), overrides.begin(), overrides.end());
    Scenario    run(small_scenes::free_block(), settings);
    const auto &columns = run.particles.columns;

    std::map<unsigned int, dealii::Tensor<1, 2>> before;
    double                                       momentum = 0.;
    for (const auto &point : run.particles.handler())
      {
        const auto v = before[point.get_id()] =
          columns.v(point.get_properties());
        momentum += columns.mass(point.get_properties()) * v[1];
      }
    run.stepper->step(0., 1e-12);
    double error = 0., after = 0.;
    for (const auto &point : run.particles.handler())
      {
        const auto v = columns.v(point.get_properties());
        error += (v - before.at(point.get_id())).norm_square();
        after += columns.mass(point.get_properties()) * v[1];
      }
    return {std::sqrt(error / before.size()) / 0.1, after / momentum - 1.};
  }
} // namespace

TEST(Stepper, ProjectionsOfHigherOrderSmoothLess)
{
  const auto order = [](const std::string &k, const std::string &scheme) {
    const auto result = there_and_back(
      {"Transfer/Scheme=" + scheme, "Transfer/Projection order=" + k});
    EXPECT_LT(std::abs(result.momentum), 1e-13);
    return result.error;
  };
  const double means = order("1", "flip"), second = order("2", "flip"),
               fourth = order("4", "flip"), eighth = order("8", "flip");
  EXPECT_LT(second, 0.5 * means);
  EXPECT_LT(fourth, 0.7 * second);
  // What the functions of these nodes cannot show of a cosine is left.
  EXPECT_LT(eighth, fourth);
  EXPECT_LT(eighth, 0.15 * means);
  // With its gradients a point says nearly all of it at once.
  EXPECT_LT(order("2", "tpic"), order("1", "tpic"));
  EXPECT_LT(order("2", "tpic"), 0.15 * means);
}

TEST(Stepper, FlipIsMixedPerTime)
{
  Transfer transfer;
  transfer.flip_fraction = 0.98;
  EXPECT_EQ(transfer.flip_share(1e-3), 0.98);
  transfer.flip_interval = 2e-3;
  EXPECT_DOUBLE_EQ(transfer.flip_share(2e-3), 0.98);
  EXPECT_DOUBLE_EQ(transfer.flip_share(1e-3) * transfer.flip_share(3e-3),
                   transfer.flip_share(4e-3));
  transfer.flip_fraction = 0.;
  EXPECT_EQ(transfer.flip_share(1e-5), 0.);
}
