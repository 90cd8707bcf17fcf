#include <selkie/laws/newtonian_fluid.h>
#include <selkie/terms/term_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The volumetric part of fluids in mixed u-p form (formulation.md, 4):
    /// R_a = -sum W p g_a and R_p,a = -sum V_0 N_a (J - J^(p)), W = V_0 J.
    /// Unlike J, the pressure has no memory.
    template <int dim>
    class FluidPressureTerm : public Term<dim>
    {
    public:
      std::string
      name() const override
      {
        return "fluid pressure";
      }

      TermNeeds
      needs() const override
      {
        TermNeeds needs;
        needs.kinematics = true;
        return needs;
      }

      bool
      acts_on(const Patch<dim> &patch) const override
      {
        return patch.integration && patch.fluid;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const StepPoint<dim> &point = state.point(q);
            const auto           &kin   = state.kinematics[q];
            const auto  &law  = static_cast<const FluidLaw &>(*point.law);
            auto        &form = state.forms[q];
            const double V_0  = point.volume;
            const double W    = V_0 * kin.J;

            form.add_stress(W * -kin.p, identity(), kin);
            form.p_source -= V_0 * (kin.J - law.J_of_pressure(kin.p));
            if (!with_tangent)
              continue;
            form.add_tangent(
              V_0, kin, [&](const Tensor<1, 3> &g_a, const Tensor<1, 3> &g_b) {
                return pressure_tangent_displacement(
                  kin.p, kin.J, 0., g_a, g_b);
              });
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
                form.coupling[i][j] -= W * kin.c[j][i];
            form.p_stiffness += V_0 * law.dJ_dpressure(kin.p);
          }
      }
    };
  } // namespace

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_fluid_pressure()
  {
    return std::make_unique<FluidPressureTerm<dim>>();
  }

  template std::unique_ptr<const Term<2>>
  make_fluid_pressure<2>();
  template std::unique_ptr<const Term<3>>
  make_fluid_pressure<3>();
} // namespace selkie
