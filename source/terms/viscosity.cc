#include <selkie/laws/fluid_law.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/terms/effect_table.h>

#include <algorithm>

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
      explicit ViscosityTerm(const Scene<dim> &scene)
      {
        for (const auto &body : scene.bodies)
          if (const auto *law = dynamic_cast<const FluidLaw *>(body.law.get()))
            largest_nu =
              std::max(largest_nu, law->largest_viscosity() / law->density());
      }

      std::string
      name() const override
      {
        return "viscosity";
      }

      TermUse
      use() const override
      {
        TermUse use;
        use.kinematics        = true;
        use.velocity_gradient = true;
        use.stress            = true;
        use.energy            = true;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.integration && kind.fluid;
      }

      /// The unsymmetric part is of the order of mu |l| against the inertia;
      /// for water it is round-off.
      bool
      symmetric(const Newmark &newmark, const double h) const override
      {
        return largest_nu * newmark.alpha4 <= 1e-2 * h * h * newmark.alpha1;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        const double alpha4 = state.time->newmark.alpha4;
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const auto        &kin   = state.kinematics[q];
            const double       V_0   = state.point(q).volume;
            const Tensor<2, 3> d_dev = dev(sym(kin.l));
            const double       rate  = shear_rate(d_dev);
            const auto         mu    = viscosity(state, q, rate);
            state.forms[q].add_stress(V_0,
                                      viscous_stress(mu.value, kin.J, kin.l),
                                      kin);
            if (!with_tangent)
              continue;
            const Tensor<2, 3> slope = alpha4 * identity() - kin.l;
            state.forms[q].add_tangent(
              V_0, kin, [&](const Tensor<1, 3> &g_a, const Tensor<1, 3> &g_b) {
                return viscous_tangent(
                  mu.value * kin.J, d_dev, slope, g_a, g_b);
              });
            if (mu.slope != 0. && rate > 0.)
              state.forms[q].add_tangent(
                V_0,
                kin,
                [&](const Tensor<1, 3> &g_a, const Tensor<1, 3> &g_b) {
                  return shear_rate_tangent(
                    4. * kin.J * mu.slope / rate, d_dev, slope, g_a, g_b);
                });
          }
      }

      double
      dissipation(const PatchState<dim> &state) const override
      {
        double power = 0.;
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const auto  &kin  = state.kinematics[q];
            const double rate = shear_rate(dev(sym(kin.l)));
            power += state.point(q).volume *
                     viscous_dissipation(viscosity(state, q, rate).value,
                                         kin.J,
                                         kin.l);
          }
        return power;
      }

    private:
      static FluidLaw::Viscosity
      viscosity(const PatchState<dim> &state,
                const unsigned int     q,
                const double           rate)
      {
        return static_cast<const FluidLaw &>(*state.point(q).law)
          .viscosity(rate);
      }

      double largest_nu = 0; ///< of all fluids, m^2/s
    };


    template <int dim>
    class ViscosityEffect : public Effect<dim>
    {
    public:
      void
      check(const Scene<dim> &scene) const override
      {
        if (!scene.has_fluid())
          fail(scene,
               "Effects",
               "'viscosity' needs a fluid, and no body of the scene has a "
               "fluid's law");
        for (const auto &body : scene.bodies)
          {
            const auto *fluid = dynamic_cast<const FluidLaw *>(body.law.get());
            if (fluid != nullptr && fluid->largest_viscosity() > 0)
              return;
          }
        fail_without_need(scene,
                          "viscosity",
                          "Effects",
                          "the Viscosity of every fluid 0");
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &scene) const override
      {
        return std::make_shared<ViscosityTerm<dim>>(scene);
      }
    };
  } // namespace

  EffectRow
  viscosity_effect()
  {
    EffectRow row = effect_row<ViscosityEffect>(
      "viscosity",
      "",
      "The shear viscosity of the fluids' laws.",
      "a velocity gradient at every fluid point and, where it is large, an "
      "unsymmetric solver");
    row.claims = [](const ParameterEntry &entry) {
      return entry.name == "Viscosity" && !entry.sections.empty() &&
             entry.sections.back() == "Law parameters" &&
             entry.value.find_first_not_of("0.") != std::string::npos;
    };
    return row;
  }
} // namespace selkie
