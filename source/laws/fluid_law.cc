#include <selkie/laws/fluid_law.h>

#include <cmath>

namespace selkie
{
  double
  shear_rate(const Tensor<2, 3> &d_dev)
  {
    return std::sqrt(2.) * d_dev.norm();
  }


  Tensor<2, 3>
  viscous_stress(const double mu, const double J, const Tensor<2, 3> &l)
  {
    return 2. * mu * J * dev(sym(l));
  }


  Tensor<2, 3>
  viscous_tangent(const double        mu_J,
                  const Tensor<2, 3> &d_dev,
                  const Tensor<2, 3> &slope,
                  const Tensor<1, 3> &g_a,
                  const Tensor<1, 3> &g_b)
  {
    const Tensor<1, 3> d_g_a     = d_dev * g_a;
    const Tensor<1, 3> d_g_b     = d_dev * g_b;
    const Tensor<1, 3> g_a_slope = g_a * slope;
    const Tensor<1, 3> g_b_slope = g_b * slope;

    Tensor<2, 3> K = (g_a * g_b) * slope;
    K += outer_product(2. * d_g_a, g_b);
    K += outer_product(g_b, g_a_slope);
    K -= outer_product(2. * d_g_b, g_a);
    K -= outer_product(2. / 3. * g_a, g_b_slope);
    return mu_J * K;
  }


  Tensor<2, 3>
  shear_rate_tangent(const double        factor,
                     const Tensor<2, 3> &d_dev,
                     const Tensor<2, 3> &slope,
                     const Tensor<1, 3> &g_a,
                     const Tensor<1, 3> &g_b)
  {
    // d(rate) = 2 d':dl / rate with dl = slope du_b (x) g_b.
    return outer_product(factor * (d_dev * g_a), (d_dev * g_b) * slope);
  }


  Tensor<2, 3>
  pressure_tangent_displacement(const double        p,
                                const double        J,
                                const double        dp_dJ,
                                const Tensor<1, 3> &g_a,
                                const Tensor<1, 3> &g_b)
  {
    return outer_product(-J * (p + J * dp_dJ) * g_a, g_b) +
           outer_product(J * p * g_b, g_a);
  }


  double
  viscous_dissipation(const double mu, const double J, const Tensor<2, 3> &l)
  {
    return 2. * mu * J * dev(sym(l)).norm_square();
  }
} // namespace selkie
