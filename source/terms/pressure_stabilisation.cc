#include <selkie/laws/volumetric_part.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/terms/effect_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Polynomial pressure projection (Dohrmann & Bochev 2004) in the
    /// lumped-minus-consistent form of formulation.md, section 4:
    /// R_p,a = -sum V_0 (alpha/G_e) N_a (p_a - p), with the inertial modulus
    /// G_e = mu alpha4 + rho h^2 alpha1 in fluids, G + rho h^2 alpha1 in
    /// solids.
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

      TermUse
      use() const override
      {
        TermUse use;
        use.pressure = true;
        use.volume   = true;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.integration && kind.pressure;
      }

      void
      add(PatchState<dim> &state, const bool) const override
      {
        const Newmark &newmark = state.time->newmark;
        const double   h2      = state.h() * state.h();
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const Law   &law = *state.point(q).law;
            const double G_e =
              volumetric_part(law).shear_stiffness(newmark.alpha4) +
              law.density() * h2 * newmark.alpha1;
            state.forms[q].lumped -= state.point(q).volume * alpha / G_e;
          }
      }

    private:
      const double alpha;
    };


    template <int dim>
    class PressureStabilisationEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm, const SceneNames &, Scene<dim> &) override
      {
        prm.add_parameter("Stabilisation",
                          alpha,
                          "Factor alpha of the polynomial pressure projection; "
                          "0 for none. Units: none.",
                          Patterns::Double(0.));
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &) const override
      {
        return alpha > 0.
                 ? std::make_shared<PressureStabilisationTerm<dim>>(alpha)
                 : nullptr;
      }

    private:
      double alpha = 0.25;
    };
  } // namespace

  EffectRow
  pressure_stabilisation_effect()
  {
    EffectRow row = effect_row<PressureStabilisationEffect>(
      "pressure stabilisation",
      "Fluid pressure",
      "Keeps the pressure free of checkerboards; switched off by "
      "`Stabilisation = 0`.",
      "");
    row.comes_with = [](const SceneNames &names) {
      return names.has_fluid() || names.has_effect("mixed pressure");
    };
    return row;
  }
} // namespace selkie
