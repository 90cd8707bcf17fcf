#include <selkie/laws/fluid_law.h>
#include <selkie/laws/law_table.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace selkie;

namespace
{
  constexpr double mu_p = 2., tau_y = 30., m = 50.;

  std::unique_ptr<const Law>
  bingham()
  {
    dealii::ParameterHandler prm;
    const LawRow            *row = find_law("bingham fluid");
    row->declare(prm);
    prm.set("Plastic viscosity", mu_p);
    prm.set("Yield stress", tau_y);
    prm.set("Regularisation", m);
    return row->create(prm);
  }
} // namespace

TEST(BinghamFluid, ShearStressTendsToBinghams)
{
  const auto  law   = bingham();
  const auto &fluid = dynamic_cast<const FluidLaw &>(*law);
  for (const double rate : {1., 10., 100.})
    EXPECT_NEAR(fluid.viscosity(rate).value * rate,
                tau_y + mu_p * rate,
                1e-12 * tau_y + 2. * tau_y * std::exp(-m * rate));
}

TEST(BinghamFluid, CreepsAtRest)
{
  const auto  law   = bingham();
  const auto &fluid = dynamic_cast<const FluidLaw &>(*law);
  EXPECT_DOUBLE_EQ(fluid.viscosity(0.).value, mu_p + m * tau_y);
  EXPECT_DOUBLE_EQ(fluid.largest_viscosity(), mu_p + m * tau_y);
}

TEST(BinghamFluid, SlopeIsTheDerivative)
{
  const auto  law   = bingham();
  const auto &fluid = dynamic_cast<const FluidLaw &>(*law);
  for (const double rate : {1e-8, 1e-4, 1e-2, 1., 30.})
    {
      const double step = 1e-4 * std::max(rate, 1e-4);
      const double difference =
        (fluid.viscosity(rate + step).value -
         fluid.viscosity(std::max(0., rate - step)).value) /
        (rate + step - std::max(0., rate - step));
      // The mean over the step stands for the slope in its middle.
      EXPECT_NEAR(fluid.viscosity(rate).slope,
                  difference,
                  1e-6 * std::abs(difference) + tau_y * m * m * m * step / 2.)
        << rate;
    }
}

TEST(BinghamFluid, TheSeriesMeetsTheFormula)
{
  const auto   law   = bingham();
  const auto  &fluid = dynamic_cast<const FluidLaw &>(*law);
  const double rate  = 1e-5 / m;
  const auto   below = fluid.viscosity(rate * (1. - 1e-9));
  const auto   above = fluid.viscosity(rate * (1. + 1e-9));
  EXPECT_NEAR(below.value, above.value, 1e-8 * below.value);
  EXPECT_NEAR(below.slope, above.slope, 1e-4 * std::abs(below.slope));
}

TEST(BinghamFluid, NeedsTheEffectViscosity)
{
  EXPECT_EQ(find_law("bingham fluid")->needs_effect, "viscosity");
}
