#include <selkie/laws/hyperelastic_law.h>

#include <algorithm>

namespace selkie
{
  LameConstants
  lame_constants(const double E, const double nu)
  {
    check_positive("Young modulus", E);
    check_parameter(nu >= 0. && nu < 0.5,
                    "Poisson ratio",
                    nu,
                    "at least 0 and less than 0.5");
    return {E * nu / ((1. + nu) * (1. - 2. * nu)), E / (2. * (1. + nu))};
  }


  HyperelasticResponse
  response_from(const EnergyDerivatives &w, const Invariants &invariants)
  {
    const double I1 = invariants.I1;
    const double J  = invariants.J;

    HyperelasticResponse response;
    response.stress = {{J * w.WJ, 2. * (w.W1 + I1 * w.W2), -2. * w.W2}};
    response.Gamma  = {{J * J * w.WJJ + J * w.WJ,
                        2. * J * (w.W1J + I1 * w.W2J),
                        4. * (w.W11 + 2. * I1 * w.W12 + I1 * I1 * w.W22 + w.W2),
                        -2. * J * w.W2J,
                        -4. * (w.W12 + I1 * w.W22),
                        4. * w.W22,
                        -4. * w.W2,
                        -2. * J * w.WJ}};
    return response;
  }


  namespace
  {
    /// The part of (L.10) with Gamma_2 ... Gamma_7, which needs b g_a.
    Tensor<2, 3>
    tangent_terms_with_b(const std::array<double, 8> &Gamma,
                         const Tensor<2, 3>          &b,
                         const Tensor<1, 3>          &g_a,
                         const Tensor<1, 3>          &g_b)
    {
      const Tensor<1, 3> bg_a  = b * g_a;
      const Tensor<1, 3> bg_b  = b * g_b;
      const Tensor<1, 3> bbg_a = b * bg_a;
      const Tensor<1, 3> bbg_b = b * bg_b;

      Tensor<2, 3> K =
        outer_product(g_a, Gamma[1] * bg_b + Gamma[3] * bbg_b) +
        outer_product(bg_a,
                      Gamma[1] * g_b + Gamma[2] * bg_b + Gamma[4] * bbg_b) +
        outer_product(bbg_a,
                      Gamma[3] * g_b + Gamma[4] * bg_b + Gamma[5] * bbg_b);
      K += 0.5 * Gamma[6] * ((g_a * bg_b) * b + outer_product(bg_b, bg_a));
      return K;
    }
  } // namespace


  Tensor<2, 3>
  hyperelastic_tangent(const HyperelasticResponse &response,
                       const Tensor<2, 3>         &tau,
                       const Tensor<2, 3>         &b,
                       const Tensor<1, 3>         &g_a,
                       const Tensor<1, 3>         &g_b)
  {
    const auto  &Gamma = response.Gamma;
    const double half8 = 0.5 * Gamma[7];

    Tensor<2, 3> K = outer_product(Gamma[0] * g_a, g_b);
    K += outer_product(half8 * g_b, g_a);
    const double diagonal = g_a * (tau * g_b) + half8 * (g_a * g_b);
    for (unsigned int i = 0; i < 3; ++i)
      K[i][i] += diagonal;

    const bool terms_with_b =
      std::any_of(Gamma.begin() + 1, Gamma.begin() + 7, [](const double x) {
        return x != 0.;
      });
    if (terms_with_b)
      K += tangent_terms_with_b(Gamma, b, g_a, g_b);
    return K;
  }
} // namespace selkie
