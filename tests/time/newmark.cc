#include <selkie/base/exceptions.h>
#include <selkie/time/newmark.h>

#include <deal.II/base/tensor.h>

#include <gtest/gtest.h>

#include <cmath>

using selkie::Newmark;

TEST(Newmark, Coefficients)
{
  const Newmark newmark(0.3025, 0.6, 0.02);
  EXPECT_NEAR(newmark.alpha1, 8264.462809917355, 1e-9);
  EXPECT_NEAR(newmark.alpha2, 165.28925619834712, 1e-11);
  EXPECT_NEAR(newmark.alpha3, 0.6528925619834711, 1e-14);
  EXPECT_NEAR(newmark.alpha4, 99.17355371900827, 1e-11);
  EXPECT_NEAR(newmark.alpha5, -0.9834710743801653, 1e-14);
  EXPECT_NEAR(newmark.alpha6, 1.6528925619834725e-4, 1e-15);
  EXPECT_DOUBLE_EQ(Newmark::beta_for(0.6), 0.3025);
  EXPECT_DOUBLE_EQ(Newmark::beta_for(0.5), 0.25);
}


// Constant acceleration is followed exactly by any member of the family.
TEST(Newmark, ExactForConstantAcceleration)
{
  const dealii::Tensor<1, 2> v({1.5, -2.});
  const dealii::Tensor<1, 2> a({-9.81, 4.});
  for (const double gamma : {0.5, 0.6, 0.9})
    {
      const Newmark newmark(Newmark::beta_for(gamma), gamma, 0.01);
      const auto    du = newmark.predictor(v, a);
      EXPECT_LT((du - (0.01 * v + 0.5e-4 * a)).norm(), 1e-15);
      EXPECT_LT((newmark.acceleration(du, v, a) - a).norm(), 1e-11);
      EXPECT_LT((newmark.velocity(du, v, a) - (v + 0.01 * a)).norm(), 1e-13);
    }
}


namespace
{
  struct Oscillator
  {
    double u = 1., v = 0., a = -4.; // a = -omega^2 u, omega = 2

    double
    energy() const
    {
      return 0.5 * v * v + 2. * u * u;
    }

    void
    step(const Newmark &newmark)
    {
      // acceleration(du) = -4 (u + du) is linear in du
      const double at_zero = newmark.acceleration(0., v, a);
      const double du      = -(at_zero + 4. * u) / (newmark.alpha1 + 4.);
      const double v_new   = newmark.velocity(du, v, a);
      a                    = newmark.acceleration(du, v, a);
      v                    = v_new;
      u += du;
    }
  };

  double
  error_at_one(const double gamma, const unsigned int steps)
  {
    Oscillator    oscillator;
    const Newmark newmark(Newmark::beta_for(gamma), gamma, 1. / steps);
    for (unsigned int i = 0; i < steps; ++i)
      oscillator.step(newmark);
    return std::abs(oscillator.u - std::cos(2.));
  }
} // namespace


TEST(Newmark, Order)
{
  EXPECT_NEAR(std::log2(error_at_one(0.5, 100) / error_at_one(0.5, 200)),
              2.,
              0.01);
  EXPECT_NEAR(std::log2(error_at_one(0.6, 800) / error_at_one(0.6, 1600)),
              1.,
              0.05);
}


TEST(Newmark, TrapezoidalRuleKeepsEnergyOthersDamp)
{
  Oscillator    kept, damped;
  const Newmark trapezoidal(0.25, 0.5, 0.3);
  const Newmark dissipative(Newmark::beta_for(0.6), 0.6, 0.3);
  for (unsigned int i = 0; i < 1000; ++i)
    {
      kept.step(trapezoidal);
      damped.step(dissipative);
    }
  EXPECT_NEAR(kept.energy(), 2., 1e-11);
  EXPECT_LT(damped.energy(), 1e-3);
}


TEST(Newmark, RefusesBadValues)
{
  EXPECT_THROW(Newmark(0., 0.5, 0.1), selkie::SceneError);
  EXPECT_THROW(Newmark(0.25, -0.5, 0.1), selkie::SceneError);
  EXPECT_THROW(Newmark(0.25, 0.5, std::nan("")), selkie::SceneError);
}
