// The forecast of a run's time from its first steps.
#include <selkie/drivers/forecast.h>

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
