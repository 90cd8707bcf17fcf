#include <selkie/laws/law_table.h>
#include <selkie/laws/newtonian_fluid.h>

#include <cmath>

namespace selkie
{
  namespace
  {
    /// Bingham's plastic in Papanastasiou's form (J. Rheol. 31, 1987): below
    /// the yield stress the fluid creeps with the viscosity mu_p + m tau_y,
    ///   mu = mu_p + tau_y (1 - exp(-m rate)) / rate.
    /// The pressure is that of the Newtonian fluid.
    class BinghamFluid : public NewtonianFluid
    {
    public:
      explicit BinghamFluid(dealii::ParameterHandler &prm)
        : NewtonianFluid(prm.get_double("Bulk modulus"),
                         prm.get_double("Pressure exponent"),
                         prm.get_double("Reference pressure"),
                         prm.get_double("Plastic viscosity"),
                         prm.get_double("Density"))
        , mu_p(prm.get_double("Plastic viscosity"))
        , tau_y(prm.get_double("Yield stress"))
        , m(prm.get_double("Regularisation"))
      {
        check_positive("Yield stress", tau_y);
        check_positive("Regularisation", m);
      }

      Viscosity
      viscosity(const double rate) const override
      {
        const double x = m * rate;
        if (x < 1e-5) // the series: the quotients below lose all digits
          return {mu_p + tau_y * m * (1. - x / 2.), -tau_y * m * m / 2.};
        const double yielded = -std::expm1(-x); // 1 - exp(-x)
        return {mu_p + tau_y * yielded / rate,
                tau_y * ((1. - yielded) * x - yielded) / (rate * rate)};
      }

      double
      largest_viscosity() const override
      {
        return mu_p + tau_y * m;
      }

    private:
      const double mu_p, tau_y, m;
    };


    void
    declare_bingham_fluid(dealii::ParameterHandler &prm)
    {
      using dealii::Patterns::Double;
      declare_compressible_fluid(prm);
      prm.declare_entry("Plastic viscosity",
                        "1",
                        Double(0.),
                        "Slope of the shear stress over the rate of shear "
                        "where the fluid flows; at least 0. Units: Pa s.");
      prm.declare_entry("Yield stress",
                        "10",
                        Double(0.),
                        "Shear stress below which it only creeps; greater "
                        "than 0. Units: Pa.");
      prm.declare_entry("Regularisation",
                        "100",
                        Double(0.),
                        "m: it creeps with the viscosity Plastic viscosity + m "
                        "Yield stress; greater than 0. Units: s.");
    }


    std::unique_ptr<const Law>
    create_bingham_fluid(dealii::ParameterHandler &prm)
    {
      return std::make_unique<const BinghamFluid>(prm);
    }
  } // namespace


  LawRow
  bingham_fluid_law()
  {
    return {"bingham fluid",
            "Weakly compressible plastic that flows above a yield stress (mud, "
            "fresh concrete), in Papanastasiou's regularised form.",
            &declare_bingham_fluid,
            &create_bingham_fluid,
            "viscosity"};
  }
} // namespace selkie
