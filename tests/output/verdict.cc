#include <selkie/output/verdict.h>
#include <selkie/solver/newton.h>

#include <gtest/gtest.h>

#include <limits>

using namespace selkie;

TEST(Verdict, NamesTheFirstOffence)
{
  Verdict verdict;
  verdict.look("gain", 0.01, {{0.1, 0.5}}, 1.);
  EXPECT_EQ(verdict.text(), "pass");
  verdict.look("gain", 0.2, {{0.1, 0.5}}, 2.);
  verdict.look("gain", 0.3, {{0.1, 0.5}}, 3.);
  EXPECT_EQ(verdict.grade(), Verdict::Grade::warn);
  EXPECT_EQ(verdict.text(), "warn: gain 0.3 (above 0.1 from t = 2 s on)");
  verdict.look("J", 0.01, {{0.2, 0.05}}, 4., true);
  EXPECT_EQ(verdict.grade(), Verdict::Grade::fail);
}

TEST(Verdict, WhatIsNotFiniteFailsAndZeroIsNoLimit)
{
  Verdict      verdict;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  verdict.look("unlimited", 1e300, {{0., 0.}}, 1.);
  EXPECT_EQ(verdict.grade(), Verdict::Grade::pass);
  verdict.look("gain", nan, {{0.1, 0.5}}, 1.);
  EXPECT_EQ(verdict.grade(), Verdict::Grade::fail);
}

TEST(ForcingTerms, AskForNoMoreThanNewtonCanUse)
{
  const ForcingTerms forcing;
  EXPECT_EQ(forcing.tolerance(1e6, 0.), forcing.loosest);
  EXPECT_EQ(forcing.tolerance(1e2, 1e6), forcing.loosest); // 1e-3 would do
  EXPECT_EQ(forcing.tolerance(1e12, 1e14), 1e-5);          // quadratic at best
  EXPECT_EQ((ForcingTerms{1e-8, 1e-12}).tolerance(1e2, 0.), 1e-8);
}
