#include <selkie/laws/hyperelastic_law.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/terms/effect_table.h>
#include <selkie/terms/elastic_force.h>

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

      TermUse
      use() const override
      {
        TermUse use;
        use.kinematics = true;
        use.stress     = true;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.integration && !kind.fluid && !kind.pressure;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const auto &law =
              static_cast<const HyperelasticLaw &>(*state.point(q).law);
            add_elastic_stress(
              state,
              q,
              [&law](const Invariants &at) { return law.response(at); },
              with_tangent);
          }
      }
    };


    template <int dim>
    class ElasticityEffect : public Effect<dim>
    {
    public:
      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &) const override
      {
        return std::make_shared<ElasticityTerm<dim>>();
      }
    };
  } // namespace

  EffectRow
  elasticity_effect()
  {
    EffectRow row = effect_row<ElasticityEffect>(
      "elasticity", "", "The stress of solids, by their laws.", "");
    row.comes_with = [](const SceneNames &names) {
      return names.has_effect("mixed pressure") ? names.has_coupled_solid()
                                                : names.has_solid();
    };
    return row;
  }
} // namespace selkie
