#include <selkie/laws/newtonian_fluid.h>

#include <deal.II/differentiation/ad.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "states.h"

using namespace selkie;
using namespace selkie_test;

namespace
{
  using Dual = Sacado::Fad::DFad<double>;

  const double         K = 2e3, n = 7., p0 = 30., mu = 11., rho = 997.5;
  const double         alpha4 = 40.;
  const NewtonianFluid fluid(K, n, p0, mu, rho);

  /// tau g_a of the whole fluid, pressure from J, by the library's functions.
  Tensor<1, 3>
  residual(const State &state, const bool with_pressure)
  {
    const double J   = determinant(state.F());
    Tensor<2, 3> tau = viscous_stress(mu, J, state.l());
    if (with_pressure)
      tau -= J * fluid.pressure(J) * identity();
    return tau * state.push_forward(state.G_a);
  }

  /// Its derivative by du_b by the library's functions.
  Tensor<2, 3>
  tangent(const State &state, const bool with_pressure)
  {
    const double       J      = determinant(state.F());
    const Tensor<1, 3> g_a    = state.push_forward(state.G_a);
    const Tensor<1, 3> g_b    = state.push_forward(state.G_b);
    Tensor<2, 3>       result = viscous_tangent(
      mu * J, dev(sym(state.l())), alpha4 * identity() - state.l(), g_a, g_b);
    if (with_pressure)
      result += pressure_tangent_displacement(
        fluid.pressure(J), J, fluid.dpressure_dJ(J), g_a, g_b);
    return result;
  }

  /// The same by automatic differentiation of tau g_a, written from the
  /// definitions with nothing of the library.
  Tensor<2, 3>
  tangent_by_dual(const State &state)
  {
    using std::pow;
    Tensor<2, 3, Dual> f, grad_n_v;
    for (unsigned int i = 0; i < 3; ++i)
      {
        const Dual du(3, i, 0.);
        for (unsigned int j = 0; j < 3; ++j)
          {
            f[i][j]        = state.f[i][j] + du * state.G_b[j];
            grad_n_v[i][j] = state.grad_n_v[i][j] + alpha4 * du * state.G_b[j];
          }
      }
    const Tensor<2, 3, Dual> f_inverse = invert(f);
    const Tensor<2, 3, Dual> l         = grad_n_v * f_inverse;
    const Dual               J = determinant(f) * determinant(state.F_n);
    const Dual               p = p0 + K / n * (pow(J, -n) - 1.);
    const Dual               divergence = trace(l);

    Tensor<2, 3> result;
    for (unsigned int i = 0; i < 3; ++i)
      {
        Dual r = 0.;
        for (unsigned int j = 0; j < 3; ++j)
          {
            Dual tau = mu * J * (l[i][j] + l[j][i]);
            if (i == j)
              tau -= J * p + 2. / 3. * mu * J * divergence;
            Dual g = 0.;
            for (unsigned int k = 0; k < 3; ++k)
              g += f_inverse[k][j] * state.G_a[k];
            r += tau * g;
          }
        for (unsigned int k = 0; k < 3; ++k)
          result[i][k] = r.dx(k);
      }
    return result;
  }
} // namespace


TEST(LawsFluid, PressureAndItsInverse)
{
  EXPECT_DOUBLE_EQ(fluid.pressure(1.), p0);
  EXPECT_DOUBLE_EQ(fluid.dpressure_dJ(1.), -K);
  EXPECT_DOUBLE_EQ(fluid.sound_speed(), std::sqrt(K / rho));
  EXPECT_EQ(fluid.phase(), Phase::fluid);
  for (const double J : {0.5, 0.9, 0.999, 1., 1.001, 1.1, 2.})
    {
      const double p = fluid.pressure(J);
      // in tension p flattens out, so its inverse loses digits
      EXPECT_NEAR(fluid.J_of_pressure(p), J, 1e-12);
      EXPECT_NEAR(fluid.dJ_dpressure(p) * fluid.dpressure_dJ(J), 1., 1e-11);

      const double h = 1e-5;
      EXPECT_NEAR(fluid.dpressure_dJ(J),
                  (fluid.pressure(J + h) - fluid.pressure(J - h)) / (2. * h),
                  1e-7 * std::abs(fluid.dpressure_dJ(J)));
    }
}


TEST(LawsFluid, EnergyOfCompression)
{
  EXPECT_NEAR(fluid.energy(1.), 0., 1e-12);
  for (const double J : {0.7, 0.95, 1., 1.05, 1.6})
    {
      const double h = 1e-5;
      EXPECT_NEAR((fluid.energy(J + h) - fluid.energy(J - h)) / (2. * h),
                  -fluid.pressure(J),
                  1e-7 * K);
      const Dual W =
        K / n * (Dual(1, 0, J) + (pow(Dual(1, 0, J), 1. - n) - n) / (n - 1.)) -
        p0 * (Dual(1, 0, J) - 1.);
      EXPECT_NEAR(W.val(), fluid.energy(J), 1e-11 * K);
      EXPECT_NEAR(W.dx(0), -fluid.pressure(J), 1e-11 * K);
    }
}


TEST(LawsFluid, OutOfRangeIsAnError)
{
  const double lowest = p0 - K / n;
  EXPECT_NO_THROW(fluid.J_of_pressure(lowest + 1.));
  for (const double p : {lowest, lowest - 100., std::nan("")})
    {
      EXPECT_THROW(fluid.J_of_pressure(p), NumericalFailure);
      EXPECT_THROW(fluid.dJ_dpressure(p), NumericalFailure);
    }
  try
    {
      fluid.J_of_pressure(-1234.);
      FAIL();
    }
  catch (const NumericalFailure &failure)
    {
      EXPECT_NE(std::string(failure.what()).find("-1234"), std::string::npos);
    }
  for (const double J : {0., -0.5, std::nan("")})
    {
      EXPECT_THROW(fluid.pressure(J), InvertedPoint);
      EXPECT_THROW(fluid.dpressure_dJ(J), InvertedPoint);
      EXPECT_THROW(fluid.energy(J), InvertedPoint);
    }
}


TEST(LawsFluid, TangentIsDerivativeOfResidualByDifferences)
{
  for (const State &state : random_states())
    for (const bool with_pressure : {false, true})
      {
        const auto moved_residual = [&](const Tensor<1, 3> &du) {
          return residual(state.moved(du, alpha4), with_pressure);
        };
        EXPECT_GT(std::abs(trace(state.l())), 1e-2);
        EXPECT_LT(relative_difference(tangent(state, with_pressure),
                                      difference_quotient(moved_residual)),
                  1e-7);
      }
}


TEST(LawsFluid, TangentIsDerivativeOfResidualBySacado)
{
  for (const State &state : random_states())
    EXPECT_LT(relative_difference(tangent(state, true), tangent_by_dual(state)),
              1e-12);
}


// A pressure of its own (mixed form): only the geometry changes.
TEST(LawsFluid, TangentAtGivenPressure)
{
  const double p = 123.;
  for (const State &state : random_states())
    {
      const auto moved_residual = [&](const Tensor<1, 3> &du) {
        const State moved = state.moved(du, 0.);
        return Tensor<1, 3>(-determinant(moved.F()) * p *
                            moved.push_forward(state.G_a));
      };
      const Tensor<2, 3> result =
        pressure_tangent_displacement(p,
                                      determinant(state.F()),
                                      0.,
                                      state.push_forward(state.G_a),
                                      state.push_forward(state.G_b));
      EXPECT_LT((result - difference_quotient(moved_residual)).norm(), 1e-5);
    }
}


TEST(LawsFluid, PressureTangentIsSymmetric)
{
  for (const State &s : random_states())
    EXPECT_LT((pressure_tangent_displacement(3., 0.9, -7., s.G_a, s.G_b) -
               transpose(
                 pressure_tangent_displacement(3., 0.9, -7., s.G_b, s.G_a)))
                .norm(),
              1e-14);
}


TEST(LawsFluid, Objectivity)
{
  std::mt19937 generator(5);
  for (const State &state : random_states())
    {
      const Tensor<2, 3> Q = random_rotation(generator);
      // any spin may be added by a moving observer
      const Tensor<2, 3> a    = random_tensor<3>(generator, 4.);
      const Tensor<2, 3> spin = a - transpose(a);
      const Tensor<2, 3> l    = state.l();
      EXPECT_LT(relative_difference(
                  viscous_stress(mu, 0.9, Q * l * transpose(Q) + spin),
                  Q * viscous_stress(mu, 0.9, l) * transpose(Q)),
                1e-12);
    }
}


TEST(LawsFluid, DissipationIsNeverNegative)
{
  std::mt19937 generator(7);
  for (unsigned int i = 0; i < 1000; ++i)
    {
      const Tensor<2, 3> l =
        i % 2 == 0 ? random_tensor<3>(generator, 10.)
                   : extend(random_tensor<2>(generator, 10.), /*zz=*/0.);
      const double power = viscous_dissipation(mu, 0.9, l);
      EXPECT_GE(power, 0.);
      EXPECT_NEAR(scalar_product(viscous_stress(mu, 0.9, l), l),
                  power,
                  1e-12 * power);
    }
  // rigid rotation and pure dilatation dissipate nothing
  EXPECT_NEAR(viscous_dissipation(mu, 1., 2. * identity()), 0., 1e-12);
  Tensor<2, 3> spin;
  spin[0][1] = -(spin[1][0] = 3.);
  EXPECT_EQ(viscous_dissipation(mu, 1., spin), 0.);
}
