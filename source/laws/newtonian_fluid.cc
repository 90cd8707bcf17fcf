#include <selkie/laws/law_table.h>
#include <selkie/laws/newtonian_fluid.h>

#include <cmath>
#include <sstream>

namespace selkie
{
  namespace
  {
    using dealii::ParameterHandler;
    using dealii::Patterns::Double;

    void
    declare_newtonian_fluid(ParameterHandler &prm)
    {
      declare_compressible_fluid(prm);
      prm.declare_entry("Viscosity",
                        "1e-3",
                        Double(0.),
                        "Dynamic shear viscosity; at least 0. Units: Pa s.");
    }


    std::unique_ptr<const Law>
    create_newtonian_fluid(ParameterHandler &prm)
    {
      return std::make_unique<const NewtonianFluid>(
        prm.get_double("Bulk modulus"),
        prm.get_double("Pressure exponent"),
        prm.get_double("Reference pressure"),
        prm.get_double("Viscosity"),
        prm.get_double("Density"));
    }
  } // namespace


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
  NewtonianFluid::bulk_modulus() const
  {
    return K;
  }


  FluidLaw::Viscosity
  NewtonianFluid::viscosity(const double) const
  {
    return {mu};
  }


  double
  NewtonianFluid::largest_viscosity() const
  {
    return mu;
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

  LawRow
  newtonian_fluid_law()
  {
    return {
      "newtonian fluid",
      "Weakly compressible fluid with p = p0 + K/n (J^-n - 1) and a constant "
      "shear viscosity.",
      &declare_newtonian_fluid,
      &create_newtonian_fluid};
  }
} // namespace selkie
