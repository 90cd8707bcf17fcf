#include <selkie/laws/hyperelastic_law.h>
#include <selkie/terms/term_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The internal force of solids, volumetric and deviatoric part together:
    /// R_a = sum_p V_0 tau g_a, K_ab by the paper's (B16)-(B17).
    template <int dim>
    class ElasticityTerm : public Term<dim>
    {
    public:
      std::string
      name() const override
      {
        return "elasticity";
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
        return patch.integration && !patch.fluid;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const StepPoint<dim> &point = state.point(q);
            const auto           &kin   = state.kinematics[q];
            const auto &law = static_cast<const HyperelasticLaw &>(*point.law);
            const Tensor<2, 3> F = kin.f * extend(point.F_n);
            const Tensor<2, 3> b = left_cauchy_green(F);

            const HyperelasticResponse response =
              law.response(invariants(b, determinant(F)));
            const Tensor<2, 3> tau = kirchhoff_stress(response, b);
            state.forms[q].add_stress(point.volume, tau, kin);
            if (with_tangent)
              state.forms[q].add_tangent(
                point.volume,
                kin,
                [&](const Tensor<1, 3> &g_a, const Tensor<1, 3> &g_b) {
                  return hyperelastic_tangent(response, tau, b, g_a, g_b);
                });
          }
      }
    };
  } // namespace

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_elasticity()
  {
    return std::make_unique<ElasticityTerm<dim>>();
  }

  template std::unique_ptr<const Term<2>>
  make_elasticity<2>();
  template std::unique_ptr<const Term<3>>
  make_elasticity<3>();
} // namespace selkie
