#include <selkie/laws/isochoric_neo_hookean.h>
#include <selkie/laws/mooney_rivlin.h>
#include <selkie/laws/neo_hookean.h>
#include <selkie/laws/saint_venant_kirchhoff.h>

#include <deal.II/differentiation/ad.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "states.h"

using namespace selkie;
using namespace selkie_test;

namespace
{
  using Dual     = Sacado::Fad::DFad<double>;
  using DualDual = Sacado::Fad::DFad<Dual>;

  const double E = 1.2e5, nu = 0.3, rho = 1100.;
  const double G   = E / (2. * (1. + nu));
  const double L   = 2. * G * nu / (1. - 2. * nu);
  const double C10 = 2e4, C01 = 7e3, K = 1.1e5;

  // The energies again, from F by their textbook form in C = F^T F, so that
  // nothing of the library is used.
  template <typename Number>
  Number
  neo_hookean_energy(const Tensor<2, 3, Number> &F)
  {
    using std::log;
    const Number J    = determinant(F);
    const Number tr_C = trace(transpose(F) * F);
    return G / 2. * (tr_C - 3.) - G * log(J) +
           L / 4. * (J * J - 1. - 2. * log(J));
  }

  template <typename Number>
  Number
  isochoric_energy(const Tensor<2, 3, Number> &F)
  {
    using std::log;
    using std::pow;
    const Number J    = determinant(F);
    const Number tr_C = trace(transpose(F) * F);
    return G / 2. * (tr_C * pow(J, -2. / 3.) - 3.) +
           (L + 2. / 3. * G) / 4. * (J * J - 1. - 2. * log(J));
  }

  template <typename Number>
  Number
  saint_venant_kirchhoff_energy(const Tensor<2, 3, Number> &F)
  {
    Tensor<2, 3, Number> strain = transpose(F) * F;
    for (unsigned int i = 0; i < 3; ++i)
      strain[i][i] -= 1.;
    strain *= Number(0.5);
    const Number tr = trace(strain);
    return L / 2. * tr * tr + G * scalar_product(strain, strain);
  }

  template <typename Number>
  Number
  mooney_rivlin_energy(const Tensor<2, 3, Number> &F)
  {
    using std::log;
    const Tensor<2, 3, Number> C  = transpose(F) * F;
    const Number               J  = determinant(F);
    const Number               I1 = trace(C);
    const Number               I2 = 0.5 * (I1 * I1 - trace(C * C));
    return C10 * (I1 - 3.) + C01 * (I2 - 3.) - (2. * C10 + 4. * C01) * log(J) +
           (K - 4. / 3. * C10 - 16. / 3. * C01) / 4. *
             (J * J - 1. - 2. * log(J));
  }

  struct Case
  {
    std::string                                             name;
    std::shared_ptr<const HyperelasticLaw>                  law;
    std::function<double(const Tensor<2, 3> &)>             energy;
    std::function<Dual(const Tensor<2, 3, Dual> &)>         energy_dual;
    std::function<DualDual(const Tensor<2, 3, DualDual> &)> energy_dual_dual;
  };

  std::vector<Case>
  cases()
  {
    return {{"neo hookean",
             std::make_shared<NeoHookean>(E, nu, rho),
             &neo_hookean_energy<double>,
             &neo_hookean_energy<Dual>,
             &neo_hookean_energy<DualDual>},
            {"isochoric neo hookean",
             std::make_shared<IsochoricNeoHookean>(E, nu, rho),
             &isochoric_energy<double>,
             &isochoric_energy<Dual>,
             &isochoric_energy<DualDual>},
            {"saint venant kirchhoff",
             std::make_shared<SaintVenantKirchhoff>(E, nu, rho),
             &saint_venant_kirchhoff_energy<double>,
             &saint_venant_kirchhoff_energy<Dual>,
             &saint_venant_kirchhoff_energy<DualDual>},
            {"mooney rivlin",
             std::make_shared<MooneyRivlin>(C10, C01, K, rho),
             &mooney_rivlin_energy<double>,
             &mooney_rivlin_energy<Dual>,
             &mooney_rivlin_energy<DualDual>}};
  }

  Tensor<2, 3>
  tau_of(const HyperelasticLaw &law, const Tensor<2, 3> &F)
  {
    return kirchhoff_stress(law.response(invariants(F)), left_cauchy_green(F));
  }

  Tensor<2, 3>
  tangent_of(const HyperelasticLaw &law,
             const State           &state,
             const Tensor<1, 3>    &g_a,
             const Tensor<1, 3>    &g_b)
  {
    const Tensor<2, 3> F        = state.F();
    const auto         response = law.response(invariants(F));
    const Tensor<2, 3> b        = left_cauchy_green(F);
    return hyperelastic_tangent(
      response, kirchhoff_stress(response, b), b, g_a, g_b);
  }

  /// dW/dF by automatic differentiation.
  Tensor<2, 3>
  first_piola_by_dual(const Case &c, const Tensor<2, 3> &F)
  {
    Tensor<2, 3, Dual> F_dual;
    for (unsigned int i = 0; i < 9; ++i)
      F_dual[i / 3][i % 3] = Dual(9, i, F[i / 3][i % 3]);
    const Dual   W = c.energy_dual(F_dual);
    Tensor<2, 3> P;
    for (unsigned int i = 0; i < 9; ++i)
      P[i / 3][i % 3] = W.dx(i);
    return P;
  }

  /// d^2 W / d du_a d du_b of W((f + du_a (x) G_a + du_b (x) G_b) F_n) by
  /// nested automatic differentiation: the tangent by its definition.
  Tensor<2, 3>
  tangent_by_dual(const Case &c, const State &state)
  {
    std::array<DualDual, 6> du;
    for (unsigned int i = 0; i < 6; ++i)
      du[i] = DualDual(6, i, Dual(6, i, 0.));

    Tensor<2, 3, DualDual> f, F;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        f[i][j] =
          state.f[i][j] + du[i] * state.G_a[j] + du[3 + i] * state.G_b[j];
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        {
          F[i][j] = 0.;
          for (unsigned int k = 0; k < 3; ++k)
            F[i][j] += f[i][k] * state.F_n[k][j];
        }
    const DualDual W = c.energy_dual_dual(F);
    Tensor<2, 3>   result;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int k = 0; k < 3; ++k)
        result[i][k] = W.dx(i).dx(3 + k);
    return result;
  }
} // namespace


TEST(LawsHyperelastic, EnergyIsTheTextbookOne)
{
  for (const Case &c : cases())
    for (const State &state : random_states())
      {
        const Tensor<2, 3> F = state.F();
        const double       W = c.law->energy(invariants(F));
        EXPECT_NEAR(W, c.energy(F), 1e-12 * E) << c.name;
        EXPECT_GT(W, 0.) << c.name;
      }
}


TEST(LawsHyperelastic, StressIsDerivativeOfEnergyByDifferences)
{
  const double h = 1e-5;
  for (const Case &c : cases())
    for (const State &state : random_states())
      {
        const Tensor<2, 3> F = state.F();
        Tensor<2, 3>       P;
        for (unsigned int i = 0; i < 9; ++i)
          {
            Tensor<2, 3> dF;
            dF[i / 3][i % 3] = h;
            P[i / 3][i % 3]  = (c.law->energy(invariants(F + dF)) -
                               c.law->energy(invariants(F - dF))) /
                              (2. * h);
          }
        EXPECT_LT(relative_difference(tau_of(*c.law, F), P * transpose(F)),
                  1e-7)
          << c.name;
      }
}


TEST(LawsHyperelastic, StressIsDerivativeOfEnergyBySacado)
{
  for (const Case &c : cases())
    for (const State &state : random_states())
      {
        const Tensor<2, 3> F = state.F();
        EXPECT_LT(relative_difference(tau_of(*c.law, F),
                                      first_piola_by_dual(c, F) * transpose(F)),
                  1e-12)
          << c.name;
      }
}


TEST(LawsHyperelastic, TangentIsDerivativeOfResidualByDifferences)
{
  for (const Case &c : cases())
    for (const State &state : random_states())
      {
        const auto residual = [&](const Tensor<1, 3> &du) {
          const State        moved = state.moved(du, 0.);
          const Tensor<2, 3> tau   = tau_of(*c.law, moved.F());
          return Tensor<1, 3>(tau * moved.push_forward(state.G_a));
        };
        EXPECT_LT(relative_difference(tangent_of(*c.law,
                                                 state,
                                                 state.push_forward(state.G_a),
                                                 state.push_forward(state.G_b)),
                                      difference_quotient(residual)),
                  1e-7)
          << c.name;
      }
}


TEST(LawsHyperelastic, TangentIsSecondDerivativeOfEnergyBySacado)
{
  for (const Case &c : cases())
    for (const State &state : random_states())
      EXPECT_LT(relative_difference(tangent_of(*c.law,
                                               state,
                                               state.push_forward(state.G_a),
                                               state.push_forward(state.G_b)),
                                    tangent_by_dual(c, state)),
                1e-12)
        << c.name;
}


TEST(LawsHyperelastic, TangentIsSymmetric)
{
  for (const Case &c : cases())
    for (const State &state : random_states())
      EXPECT_LT(relative_difference(
                  tangent_of(*c.law, state, state.G_a, state.G_b),
                  transpose(tangent_of(*c.law, state, state.G_b, state.G_a))),
                1e-14)
        << c.name;
}


// A law with all nine derivatives of W(I1, I2, J) nonzero, so that every
// Gamma_k of the general form is exercised.
TEST(LawsHyperelastic, GeneralFormWithAllGammas)
{
  class Everything : public HyperelasticLaw
  {
  public:
    double
    density() const override
    {
      return 1.;
    }
    double
    sound_speed() const override
    {
      return 1.;
    }
    double
    energy(const Invariants &i) const override
    {
      return i.I1 * i.I1 * i.I2 + i.I2 * i.I2 * i.J + i.J * i.J * i.J * i.I1;
    }
    HyperelasticResponse
    response(const Invariants &i) const override
    {
      EnergyDerivatives w;
      w.W1  = 2. * i.I1 * i.I2 + i.J * i.J * i.J;
      w.W2  = i.I1 * i.I1 + 2. * i.I2 * i.J;
      w.WJ  = i.I2 * i.I2 + 3. * i.J * i.J * i.I1;
      w.W11 = 2. * i.I2;
      w.W12 = 2. * i.I1;
      w.W22 = 2. * i.J;
      w.W1J = 3. * i.J * i.J;
      w.W2J = 2. * i.I2;
      w.WJJ = 6. * i.J * i.I1;
      return response_from(w, i);
    }
  };
  const auto energy = [](const Tensor<2, 3, DualDual> &F) {
    const Tensor<2, 3, DualDual> C  = transpose(F) * F;
    const DualDual               J  = determinant(F);
    const DualDual               I1 = trace(C);
    const DualDual               I2 = 0.5 * (I1 * I1 - trace(C * C));
    return DualDual(I1 * I1 * I2 + I2 * I2 * J + J * J * J * I1);
  };
  const Case c{"all", std::make_shared<Everything>(), {}, {}, energy};
  for (const State &state : random_states())
    EXPECT_LT(relative_difference(tangent_of(*c.law,
                                             state,
                                             state.push_forward(state.G_a),
                                             state.push_forward(state.G_b)),
                                  tangent_by_dual(c, state)),
              1e-12);
}


TEST(LawsHyperelastic, Objectivity)
{
  std::mt19937 generator(3);
  for (const Case &c : cases())
    for (const State &state : random_states())
      {
        const Tensor<2, 3> Q   = random_rotation(generator);
        const Tensor<2, 3> F   = state.F();
        const Tensor<2, 3> tau = tau_of(*c.law, F);
        EXPECT_LT(relative_difference(tau_of(*c.law, Q * F),
                                      Q * tau * transpose(Q)),
                  1e-12)
          << c.name;
        EXPECT_NEAR(c.law->energy(invariants(Q * F)),
                    c.law->energy(invariants(F)),
                    1e-11 * E)
          << c.name;
        // isotropy: a rotation of the reference changes nothing
        EXPECT_LT(relative_difference(tau_of(*c.law, F * Q), tau), 1e-12)
          << c.name;
      }
}


TEST(LawsHyperelastic, RestIsStressFreeAndLinearElastic)
{
  const double G_mooney = 2. * (C10 + C01);
  for (const Case &c : cases())
    {
      EXPECT_NEAR(c.law->energy(invariants(identity())), 0., 1e-10);
      EXPECT_LT(tau_of(*c.law, identity()).norm(), 1e-10) << c.name;

      const bool   mooney = c.name == "mooney rivlin";
      const double shear  = mooney ? G_mooney : G;
      const double lambda = mooney ? K - 2. / 3. * G_mooney : L;
      EXPECT_NEAR(c.law->sound_speed(),
                  std::sqrt((lambda + 2. * shear) / rho),
                  1e-12);

      State rest;
      rest.F_n = rest.f     = identity();
      const Tensor<1, 3> g  = Tensor<1, 3>({1., 0., 0.});
      const Tensor<2, 3> Kg = tangent_of(*c.law, rest, g, g);
      EXPECT_NEAR(Kg[0][0], lambda + 2. * shear, 1e-9 * E) << c.name;
      EXPECT_NEAR(Kg[1][1], shear, 1e-9 * E) << c.name;
      EXPECT_NEAR(Kg[0][1], 0., 1e-9 * E) << c.name;
    }
}


TEST(LawsHyperelastic, PaperGammasOfNeoHookean)
{
  const NeoHookean law(E, nu, rho);
  const double     J        = 0.8;
  const auto       response = law.response({2.9, 2.7, J});
  EXPECT_DOUBLE_EQ(response.Gamma[0], L * J * J);
  EXPECT_NEAR(response.Gamma[7], 2. * G - L * (J * J - 1.), 1e-10);
  for (unsigned int k = 1; k < 7; ++k)
    EXPECT_EQ(response.Gamma[k], 0.);

  // and as a Mooney-Rivlin law without its second part
  const MooneyRivlin mooney(G / 2., 0., L + 2. / 3. * G, rho);
  const auto         same = mooney.response({2.9, 2.7, J});
  for (unsigned int k = 0; k < 8; ++k)
    EXPECT_NEAR(response.Gamma[k], same.Gamma[k], 1e-10);
}


TEST(LawsHyperelastic, InvertedPointIsAnError)
{
  Tensor<2, 3> F = identity();
  F[0][0]        = -0.1;
  EXPECT_THROW(invariants(F), InvertedPoint);
  for (const Case &c : cases())
    {
      EXPECT_THROW(c.law->energy({3., 3., 0.}), InvertedPoint);
      EXPECT_THROW(c.law->response({3., 3., -1.}), InvertedPoint);
      EXPECT_THROW(c.law->response({3., 3., std::nan("")}), InvertedPoint);
    }
}


TEST(LawsHyperelastic, DecoupledPressureAndVolumeBelongTogether)
{
  const IsochoricNeoHookean law(E, 0.4999, rho);
  for (const double J : {0.6, 0.99, 1., 1.01, 1.7})
    {
      const double p = law.pressure(J), h = 1e-6;
      EXPECT_NEAR(law.J_of_pressure(p), J, 1e-12);
      EXPECT_NEAR(law.dJ_dpressure(p) * law.dpressure_dJ(J), 1., 1e-12);
      EXPECT_NEAR((law.pressure(J + h) - law.pressure(J - h)) / (2. * h) /
                    law.dpressure_dJ(J),
                  1.,
                  1e-8);
      // The shape's stress has no pressure in it.
      Tensor<2, 3> F = std::cbrt(J) * identity();
      F[0][1]        = 0.3;
      const auto b   = left_cauchy_green(F);
      EXPECT_NEAR(trace(kirchhoff_stress(
                    law.shape_response(invariants(b, determinant(F))), b)),
                  0.,
                  1e-9 * E);
    }
}
