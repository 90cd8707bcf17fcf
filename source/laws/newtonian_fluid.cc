#include <selkie/laws/newtonian_fluid.h>

#include <cmath>
#include <sstream>

namespace selkie
{
  NewtonianFluid::NewtonianFluid(const double K,
                                 const double n,
                                 const double p0,
                                 const double mu,
                                 const double rho)
    : K(K)
    , n(n)
    , p0(p0)
    , mu(mu)
    , rho(rho)
  {
    check_positive("Bulk modulus", K);
    check_parameter(n > 1. && std::isfinite(n),
                    "Pressure exponent",
                    n,
                    "greater than 1 and finite");
    check_parameter(std::isfinite(p0), "Reference pressure", p0, "finite");
    check_parameter(mu >= 0. && std::isfinite(mu),
                    "Viscosity",
                    mu,
                    "at least 0 and finite");
    check_positive("Density", rho);
  }


  double
  NewtonianFluid::density() const
  {
    return rho;
  }


  double
  NewtonianFluid::sound_speed() const
  {
    return std::sqrt(K / rho);
  }


  double
  NewtonianFluid::pressure(const double J) const
  {
    check_not_inverted(J);
    return p0 + K / n * (std::pow(J, -n) - 1.);
  }


  double
  NewtonianFluid::dpressure_dJ(const double J) const
  {
    check_not_inverted(J);
    return -K * std::pow(J, -n - 1.);
  }


  double
  NewtonianFluid::J_of_pressure(const double p) const
  {
    return std::pow(compression(p), -1. / n);
  }


  double
  NewtonianFluid::dJ_dpressure(const double p) const
  {
    return -std::pow(compression(p), -1. / n - 1.) / K;
  }


  double
  NewtonianFluid::energy(const double J) const
  {
    check_not_inverted(J);
    return K / n * (J + (std::pow(J, 1. - n) - n) / (n - 1.)) - p0 * (J - 1.);
  }


  double
  NewtonianFluid::viscosity() const
  {
    return mu;
  }


  double
  NewtonianFluid::bulk_modulus() const
  {
    return K;
  }


  double
  NewtonianFluid::compression(const double p) const
  {
    const double J_to_minus_n = 1. + n * (p - p0) / K;
    if (!(J_to_minus_n > 0.))
      {
        std::ostringstream message;
        message << "no volume ratio belongs to the pressure " << p
                << " Pa: the fluid's pressure is always above " << p0 - K / n
                << " Pa";
        throw NumericalFailure(message.str());
      }
    return J_to_minus_n;
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
  viscous_tangent(const double        mu,
                  const double        J,
                  const Tensor<2, 3> &l,
                  const double        alpha4,
                  const Tensor<1, 3> &g_a,
                  const Tensor<1, 3> &g_b)
  {
    return viscous_tangent(
      mu * J, dev(sym(l)), alpha4 * identity() - l, g_a, g_b);
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
