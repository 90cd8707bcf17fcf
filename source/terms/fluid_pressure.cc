#include <selkie/laws/fluid_law.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/terms/effect_table.h>

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
                          pressure.volume_kappa,
                          "Share of the excess of crowded points' volume that "
                          "is corrected in a step. Units: none.",
                          Patterns::Double(0., 1.));
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
