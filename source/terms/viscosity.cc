#include <selkie/laws/newtonian_fluid.h>
#include <selkie/terms/term_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The deviatoric stress of viscous fluids: tau = 2 mu J d', with the
    /// velocity gradient of the Newmark velocity; tangent by the paper's
    /// Lemmas 2-6. It makes the system unsymmetric.
    template <int dim>
    class ViscosityTerm : public Term<dim>
    {
    public:
      std::string
      name() const override
      {
        return "viscosity";
      }

      TermNeeds
      needs() const override
      {
        TermNeeds needs;
        needs.kinematics        = true;
        needs.velocity_gradient = true;
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
        const double alpha4 = state.time->newmark.alpha4;
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const auto  &kin = state.kinematics[q];
            const double V_0 = state.point(q).volume;
            const double mu =
              static_cast<const FluidLaw &>(*state.point(q).law).viscosity();
            state.forms[q].add_stress(V_0,
                                      viscous_stress(mu, kin.J, kin.l),
                                      kin);
            if (with_tangent)
              state.forms[q].add_tangent(
                V_0,
                kin,
                [&](const Tensor<1, 3> &g_a, const Tensor<1, 3> &g_b) {
                  return viscous_tangent(mu, kin.J, kin.l, alpha4, g_a, g_b);
                });
          }
      }

      double
      dissipation(const PatchState<dim> &state) const override
      {
        double power = 0.;
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          power +=
            state.point(q).volume *
            viscous_dissipation(
              static_cast<const FluidLaw &>(*state.point(q).law).viscosity(),
              state.kinematics[q].J,
              state.kinematics[q].l);
        return power;
      }
    };
  } // namespace

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_viscosity()
  {
    return std::make_unique<ViscosityTerm<dim>>();
  }

  template std::unique_ptr<const Term<2>>
  make_viscosity<2>();
  template std::unique_ptr<const Term<3>>
  make_viscosity<3>();
} // namespace selkie
