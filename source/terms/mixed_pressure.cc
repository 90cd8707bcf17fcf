#include <selkie/laws/hyperelastic_law.h>
#include <selkie/particles/fields.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/terms/effect_table.h>
#include <selkie/terms/elastic_force.h>
#include <selkie/terms/pressure_force.h>

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
        return kind.integration && !kind.fluid;
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
        if (scene.has_fluid())
          fail(scene,
               "Effects",
               "'mixed pressure' gives solids a pressure at their nodes, and "
               "those of fluids have one already: allowed are scenes with "
               "solids only");
        for (const auto &body : scene.bodies)
          if (dynamic_cast<const DecoupledLaw *>(body.law.get()) == nullptr)
            fail(scene,
                 "Bodies/" + body.name + "/Law",
                 "the effect 'mixed pressure' needs a law that decouples shape "
                 "and volume; allowed is 'isochoric neo hookean'");
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
    EffectRow row = effect_row<MixedPressureEffect>(
      "mixed pressure",
      "",
      "The pressure of solids is an unknown of its own at their nodes: no "
      "locking.",
      "a pressure at every node of solids");
    row.replaces = "elasticity";
    return row;
  }
} // namespace selkie
