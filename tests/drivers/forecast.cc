// The forecast of a run's time from its first steps.
#include <selkie/drivers/forecast.h>
#include <selkie/laws/neo_hookean.h>
#include <selkie/laws/newtonian_fluid.h>

#include <gtest/gtest.h>

using selkie::Forecast;

TEST(Forecast, TheVeryFirstStepsDoNotCount)
{
  Forecast forecast(/*t_0=*/1., /*t_end=*/11., /*wall_0=*/100.);
  double   t = 1., wall = 100.;
  for (unsigned int n = 0; n < Forecast::n_cold; ++n)
    forecast.record(t += 0.1, wall += 5., 5);
  EXPECT_FALSE(forecast.ready());
  for (unsigned int n = 0; n < 7; ++n)
    forecast.record(t += 0.1, wall += 0.5, 2);
  EXPECT_TRUE(forecast.ready());
  EXPECT_NEAR(forecast.step(), 0.5, 1e-12);
  EXPECT_NEAR(forecast.steps(), 100., 1e-9);
  EXPECT_NEAR(forecast.total(), 15. + 3.5 + forecast.growth() * 45., 1e-9);
}

TEST(Forecast, OneNewtonIterationWillNotDoForLong)
{
  const auto growth = [](const unsigned int newton_iterations) {
    Forecast forecast(0., 1., 0.);
    for (unsigned int n = 1; n <= 10; ++n)
      forecast.record(0.01 * n, n, newton_iterations);
    return forecast.growth();
  };
  EXPECT_EQ(growth(2), growth(3));
  EXPECT_GT(growth(1), growth(2));
}

TEST(Forecast, ShortStepsAreSeenUntilNoiseIsSmall)
{
  Forecast forecast(0., 1e3, 0.);
  double   t = 0., wall = 0.;
  for (unsigned int n = 0; n < 20; ++n)
    forecast.record(t += 1., wall += 1e-3, 1);
  EXPECT_FALSE(forecast.ready()); // 0.02 s, 2 % of the run
  for (unsigned int n = 0; n < 40; ++n)
    forecast.record(t += 1., wall += 1e-3, 1);
  EXPECT_TRUE(forecast.ready());
}

TEST(Forecast, ARunThatIsOverTookWhatItTook)
{
  Forecast forecast(0., 2., 0.);
  forecast.record(1., 3., 1);
  forecast.record(2., 5., 1);
  EXPECT_EQ(forecast.total(), 5.);
  EXPECT_EQ(forecast.steps(), 2.);
}

namespace
{
  /// Water of 1 m x 2 m in a box of the given width, and a solid if asked for.
  selkie::Scene<2>
  water_in_a_box(const double width, const bool solid)
  {
    selkie::Scene<2> scene;
    scene.domain.lower = dealii::Point<2>(0., 0.);
    scene.domain.upper = dealii::Point<2>(width, 3.);
    scene.gravity      = dealii::Tensor<1, 2>({0., -10.});
    scene.bodies.resize(solid ? 2 : 1);
    scene.bodies[0].law =
      std::make_shared<selkie::NewtonianFluid>(1e6, 7., 0., 0., 1000.);
    scene.bodies[0].shape = selkie::make_shape<2>("box(0, 0, 1, 2)");
    if (solid)
      {
        scene.bodies[1].law =
          std::make_shared<selkie::NeoHookean>(1e6, 0.3, 1000.);
        scene.bodies[1].shape = selkie::make_shape<2>("box(2, 0, 2.1, 1)");
      }
    return scene;
  }
} // namespace

TEST(Outlook, WaterFallsToTheFloor)
{
  const auto falling = selkie::look_ahead(water_in_a_box(4., false), 0.01);
  EXPECT_NEAR(falling.largest_step, 0.01 / std::sqrt(2. * 10. * 2.), 1e-12);
  EXPECT_EQ(falling.growth, selkie::Outlook().growth);

  const auto at_rest = selkie::look_ahead(water_in_a_box(1., false), 0.01);
  EXPECT_EQ(at_rest.largest_step, selkie::Outlook().largest_step);
  EXPECT_EQ(at_rest.growth, 1.);
}

TEST(Outlook, SolidsThatWaterMeetsCostMore)
{
  const auto scene = water_in_a_box(4., true);
  EXPECT_GT(selkie::look_ahead(scene, 0.01).growth, selkie::Outlook().growth);
}

TEST(Outlook, LaterStepsAreNoLargerThanWhatIsAhead)
{
  selkie::Outlook outlook;
  outlook.largest_step = 0.05;
  Forecast forecast(0., 1., 0., outlook);
  for (unsigned int n = 1; n <= 5; ++n)
    forecast.record(0.1 * n, n, 2);
  EXPECT_NEAR(forecast.steps(), 5. + 0.5 / 0.05, 1e-9);
}
