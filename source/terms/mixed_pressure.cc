#include <selkie/laws/hyperelastic_law.h>
#include <selkie/particles/fields.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/terms/effect_table.h>
#include <selkie/terms/elastic_force.h>
#include <selkie/terms/pressure_force.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Elasticity of solids in mixed u-p form: the stress of the shape from the
    /// displacements, R_a = sum_p V_0 tau_shape g_a, the pressure an unknown of
    /// its own as in fluids (terms/pressure_force.h).
    template <int dim>
    class MixedPressureTerm : public Term<dim>
    {
    public:
      std::string
      name() const override
      {
        return "elasticity (mixed)";
      }

      TermUse
      use() const override
      {
        TermUse use;
        use.kinematics = true;
        use.pressure   = true;
        use.stress     = true;
        use.volume     = true;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.integration && !kind.fluid && kind.pressure;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const auto &law =
              static_cast<const DecoupledLaw &>(*state.point(q).law);
            add_elastic_stress(
              state,
              q,
              [&law](const Invariants &at) { return law.shape_response(at); },
              with_tangent);
            add_pressure(state, q, law, with_tangent);
          }
      }
    };


    template <int dim>
    class MixedPressureEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &,
              const SceneNames &,
              Scene<dim> &scene) override
      {
        scene.mixed_solids = true;
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (scene.has_effect("mean dilatation"))
          fail(scene,
               "Effects",
               "'mixed pressure' and 'mean dilatation' are two cures of one "
               "ill; allowed is one of them");
        if (std::none_of(
              scene.bodies.begin(), scene.bodies.end(), [](const auto &body) {
                return body.has_pressure && body.law->phase() == Phase::solid;
              }))
          fail_without_need(scene,
                            "mixed pressure",
                            "Effects",
                            "no solid whose law decouples shape and volume "
                            "('isochoric neo hookean')");
      }

      void
      add_columns(const Scene<dim> &, ParticleFields &fields) const override
      {
        fields.add<double>("pressure", "Pa", true);
        fields.add<double>("mean volume ratio", "", false); // J^(p)
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &) const override
      {
        return std::make_shared<MixedPressureTerm<dim>>();
      }
    };
  } // namespace

  EffectRow
  mixed_pressure_effect()
  {
    return effect_row<MixedPressureEffect>(
      "mixed pressure",
      "",
      "The pressure of solids whose law decouples shape and volume is an "
      "unknown of its own at their nodes: no locking. Other solids keep their "
      "stress, fluids their pressure.",
      "a pressure at every node of solids");
  }
} // namespace selkie
