#include <selkie/base/exceptions.h>

#include <gtest/gtest.h>

TEST(Exceptions, OutsideHullCarriesItsPoint)
{
  const dealii::Point<2>       p(0.25, -1.);
  const selkie::OutsideHull<2> failure(p, "lambda diverges");
  EXPECT_EQ(failure.point, p);
  EXPECT_NE(std::string(failure.what()).find("0.25 -1"), std::string::npos);
}
