// How the time step is cut, how it grows again, and what rules it.
#include <selkie/time/time_control.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace selkie;

  constexpr double h = 0.1, sound = 10.; // m, m/s

  TimeParameters
  steps_of_a_tenth()
  {
    TimeParameters parameters;
    parameters.end_time   = 1.;
    parameters.step       = 0.1;
    parameters.easy_steps = 3;
    return parameters;
  }
} // namespace

TEST(TimeControl, ACutHalvesTheStepAndNotTheTime)
{
  TimeControl time(steps_of_a_tenth(), h, sound);
  time.advance(0., 0.);
  EXPECT_TRUE(time.cut());
  EXPECT_TRUE(time.cut());
  EXPECT_DOUBLE_EQ(time.now(), 0.1);
  EXPECT_DOUBLE_EQ(time.step(), 0.025);
  EXPECT_EQ(time.number(), 1u);
  EXPECT_EQ(time.cuts(), 2u);
}

TEST(TimeControl, CutsEndAtTheSmallestStep)
{
  auto parameters          = steps_of_a_tenth();
  parameters.smallest_step = 0.03;
  TimeControl time(parameters, h, sound);
  EXPECT_TRUE(time.cut());
  EXPECT_FALSE(time.cut());
  EXPECT_DOUBLE_EQ(time.step(), 0.05);
}

TEST(TimeControl, GrowsAgainAfterGoodStepsUpToTheSceneStep)
{
  TimeControl time(steps_of_a_tenth(), h, sound);
  ASSERT_TRUE(time.cut());
  for (const double dt : {0.05, 0.05, 0.05, 0.075, 0.075, 0.075, 0.1, 0.1})
    {
      EXPECT_DOUBLE_EQ(time.step(), dt);
      time.advance(0., 0.);
    }
  // A failure starts the count of good steps anew.
  ASSERT_TRUE(time.cut());
  EXPECT_DOUBLE_EQ(time.step(), 0.05);
  time.advance(0., 0.);
  EXPECT_DOUBLE_EQ(time.step(), 0.05);
}

TEST(TimeControl, SaysWhatRuled)
{
  auto parameters         = steps_of_a_tenth();
  parameters.acoustic_cfl = 5.; // 0.05 s
  TimeControl time(parameters, h, sound);
  EXPECT_DOUBLE_EQ(time.step(), 0.05);
  time.advance(2., 0.); // half a cell: 0.025 s
  EXPECT_DOUBLE_EQ(time.step(), 0.025);
  time.advance(0., 0.);
  ASSERT_TRUE(time.cut());
  time.advance(0., 0.);
  EXPECT_EQ(time.rules(),
            "advective CFL 33 %, acoustic CFL 33 %, failures 33 %");
}

TEST(TimeControl, TheErrorOfAStepGoesWithItsThirdPower)
{
  auto parameters          = steps_of_a_tenth();
  parameters.largest_error = 1e-3; // 1e-4 m
  TimeControl time(parameters, h, sound);
  time.advance(0., 4e-4);
  EXPECT_NEAR(time.step(), 0.09 / std::cbrt(4.), 1e-12);
  time.advance(0., 1.); // never to less than half
  EXPECT_NEAR(time.step(), 0.045 / std::cbrt(4.), 1e-12);
}

TEST(TimeControl, EndsAtTheEndTimeWithoutASliver)
{
  auto parameters     = steps_of_a_tenth();
  parameters.end_time = 0.25;
  TimeControl time(parameters, h, sound);
  for (; !time.at_end(); time.advance(0., 0.))
    EXPECT_GT(time.step(), 0.04);
  EXPECT_DOUBLE_EQ(time.now(), 0.25);
  EXPECT_EQ(time.number(), 3u);
}
