#include <selkie/laws/fluid_law.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/terms/effect_table.h>
#include <selkie/terms/pressure_force.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The volumetric part of fluids: terms/pressure_force.h.
    template <int dim>
    class FluidPressureTerm : public Term<dim>
    {
    public:
      std::string
      name() const override
      {
        return "fluid pressure";
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
        return kind.integration && kind.fluid;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          add_pressure(state,
                       q,
                       static_cast<const FluidLaw &>(*state.point(q).law),
                       with_tangent);
      }
    };


    template <int dim>
    class FluidPressureEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &,
              Scene<dim> &scene) override
      {
        FluidPressure &pressure = scene.fluid_pressure.emplace();
        prm.add_parameter("Volume correction",
                          pressure.volume_rate,
                          "Rate at which crowded points get back the volume "
                          "that they have lost; 0 for none. Units: 1/s.",
                          Patterns::Double(0.));
        prm.add_parameter("Volume deadband",
                          pressure.volume_deadband,
                          "Relative excess that is not corrected. Units: none.",
                          Patterns::Double(0.));
        prm.add_parameter("Gauss points in full cells",
                          pressure.gauss_full_cells,
                          "Whether cells in the interior of the fluid are "
                          "integrated at fixed Gauss points instead of at the "
                          "material points. Units: none.");
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (!scene.inertia)
          fail(scene,
               "Effects",
               "a scene without 'inertia' is static, and nothing but inertia "
               "keeps a fluid in shape; list 'inertia'");
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &) const override
      {
        return std::make_shared<FluidPressureTerm<dim>>();
      }
    };
  } // namespace

  EffectRow
  fluid_pressure_effect()
  {
    EffectRow row = effect_row<FluidPressureEffect>(
      "fluid pressure",
      "Fluid pressure",
      "The pressure of fluids, an unknown of its own at their nodes.",
      "");
    row.comes_with = [](const SceneNames &names) { return names.has_fluid(); };
    return row;
  }
} // namespace selkie
