#include <selkie/scene/check_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/terms/effect_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// R_a = sum_b M_ab a_b, K_ab = alpha1 M_ab, with the lumped mass
    /// M_a = sum_p m N_a or the consistent M_ab = sum_p m N_a N_b.
    template <int dim>
    class InertiaTerm : public Term<dim>
    {
    public:
      explicit InertiaTerm(const MassKind mass)
        : lumped(mass == MassKind::lumped)
      {}

      std::string
      name() const override
      {
        return "inertia";
      }

      TermUse
      use() const override
      {
        TermUse use;
        use.acceleration = !lumped;
        use.source       = !lumped;
        use.mass         = !lumped;
        use.at_nodes     = lumped;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return !lumped && kind.matter;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const double m = state.point(q).mass;
            state.forms[q].source += m * state.acceleration[q];
            if (with_tangent)
              state.forms[q].mass += m * state.time->newmark.alpha1;
          }
      }

      void
      add_at_nodes(const NodeState &state,
                   const Newmark   &newmark,
                   Vector          &residual,
                   Vector          *diagonal) const override
      {
        for (unsigned int i = 0; i < residual.locally_owned_size(); ++i)
          residual.local_element(i) += state.lumped_mass.local_element(i) *
                                       state.acceleration.local_element(i);
        if (diagonal != nullptr)
          for (unsigned int i = 0; i < residual.locally_owned_size(); ++i)
            diagonal->local_element(i) +=
              newmark.alpha1 * state.lumped_mass.local_element(i);
      }

    private:
      const bool lumped;
    };


    template <int dim>
    class InertiaEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &,
              Scene<dim> &scene) override
      {
        Inertia &inertia = scene.inertia.emplace();
        add_choice(
          prm,
          "Mass",
          inertia.mass,
          {{"automatic", MassKind::automatic},
           {"lumped", MassKind::lumped},
           {"consistent", MassKind::consistent}},
          "The mass matrix; `automatic` is consistent for `q4 fem` and "
          "lumped for material points. Units: none.");
        prm.add_parameter("Newmark beta",
                          inertia.newmark_beta,
                          "Newmark's beta, at least gamma / 2; (gamma + 1/2)^2 "
                          "/ 4 damps best. Units: none.",
                          Patterns::Double(0., 1.));
        prm.add_parameter("Newmark gamma",
                          inertia.newmark_gamma,
                          "Newmark's gamma: 0.5 keeps energy, 0.6 damps what "
                          "is faster than the step. Units: none.",
                          Patterns::Double(0.5, 1.));
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (2 * scene.inertia->newmark_beta < scene.inertia->newmark_gamma)
          fail(scene,
               "Inertia/Newmark beta",
               "Newmark's scheme is unstable below 'Newmark gamma' / 2; "
               "allowed is at least that, advised (gamma + 1/2)^2 / 4");
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &scene) const override
      {
        return std::make_shared<InertiaTerm<dim>>(scene.inertia->mass);
      }
    };
  } // namespace

  EffectRow
  inertia_effect()
  {
    return effect_row<InertiaEffect>(
      "inertia",
      "Inertia",
      "Mass resists acceleration; Newmark's scheme.",
      "velocity and acceleration of points and nodes and their exchange");
  }
} // namespace selkie
