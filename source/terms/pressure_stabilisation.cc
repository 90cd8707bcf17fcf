#include <selkie/laws/newtonian_fluid.h>
#include <selkie/terms/term_table.h>

namespace selkie
{
  namespace
  {
    /// Polynomial pressure projection (Dohrmann & Bochev 2004) in the
    /// lumped-minus-consistent form of formulation.md, section 4:
    /// R_p,a = -sum V_0 (alpha/G_e) N_a (p_a - p), with the inertial modulus
    /// G_e = mu alpha4 + rho h^2 alpha1.
    template <int dim>
    class PressureStabilisationTerm : public Term<dim>
    {
    public:
      explicit PressureStabilisationTerm(const double alpha)
        : alpha(alpha)
      {}

      std::string
      name() const override
      {
        return "pressure stabilisation";
      }

      TermNeeds
      needs() const override
      {
        return TermNeeds();
      }

      bool
      acts_on(const Patch<dim> &patch) const override
      {
        return patch.integration && patch.fluid;
      }

      void
      add(PatchState<dim> &state, const bool) const override
      {
        const Newmark &newmark = state.time->newmark;
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const auto &law =
              static_cast<const FluidLaw &>(*state.point(q).law);
            const double G_e =
              law.viscosity() * newmark.alpha4 +
              law.density() * state.h * state.h * newmark.alpha1;
            state.forms[q].lumped -= state.point(q).volume * alpha / G_e;
          }
      }

    private:
      const double alpha;
    };
  } // namespace

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_pressure_stabilisation(const double alpha)
  {
    return std::make_unique<PressureStabilisationTerm<dim>>(alpha);
  }

  template std::unique_ptr<const Term<2>>
  make_pressure_stabilisation<2>(const double);
  template std::unique_ptr<const Term<3>>
  make_pressure_stabilisation<3>(const double);
} // namespace selkie
