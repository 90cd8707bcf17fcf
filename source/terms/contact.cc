#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/terms/effect_table.h>

#include <algorithm>
#include <limits>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Nodes of two bodies at one vertex must not approach each other faster
    /// than closes the gap in the step, and may part freely:
    /// p = d max(0, v . n - max(0, gap) / dt), without friction. The damping
    /// d = C m (1 / dt + c^2 dt / h^2), with the pair's reduced mass and the
    /// least speed of sound of the scene, is C times what mass and stiffness
    /// hold against it, so that a share of about 1 / C of the speed is left
    /// (theory.md, S.8).
    template <int dim>
    class ContactTerm : public Term<dim>
    {
    public:
      ContactTerm(const double penalty, const double sound_speed)
        : penalty(penalty)
        , sound_speed(sound_speed)
      {}

      std::string
      name() const override
      {
        return "contact";
      }

      TermUse
      use() const override
      {
        TermUse use;
        use.velocity = true;
        use.stress   = true;
        use.energy   = true;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.contact;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        const double p = force(state);
        if (p == 0.)
          return;
        const double k    = damping(state) * state.time->newmark.alpha4;
        auto        &form = state.forms[0];
        for (unsigned int i = 0; i < dim; ++i)
          {
            form.flux[i][i] += p;
            if (with_tangent)
              for (unsigned int j = 0; j < dim; ++j)
                form.stiffness[i][j][i][j] += k;
          }
      }

      double
      dissipation(const PatchState<dim> &state) const override
      {
        return force(state) * along_normal(state, state.increment[0]) /
               state.time->newmark.dt;
      }

    private:
      /// Of a jump between the nodes, positive when they approach.
      static double
      along_normal(const PatchState<dim> &state, const Tensor<1, dim> &jump)
      {
        double sum = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          sum += jump[d] * state.table->gradient(*state.patch, 0, d)[0];
        return sum;
      }

      double
      damping(const PatchState<dim> &state) const
      {
        const double dt  = state.time->newmark.dt;
        const double cfl = sound_speed * dt / state.h();
        return penalty * state.point(0).mass * (1. + cfl * cfl) / dt;
      }

      /// N (N/m in 2D).
      double
      force(const PatchState<dim> &state) const
      {
        const double allowed =
          std::max(0., state.point(0).area) / state.time->newmark.dt;
        const double v = along_normal(state, state.velocity[0]);
        return damping(state) * std::max(0., v - allowed);
      }

      const double penalty, sound_speed;
    };


    template <int dim>
    class ContactEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &names,
              Scene<dim>       &scene) override
      {
        auto &chosen = scene.contact.emplace();
        prm.declare_entry(
          "Bodies",
          "",
          Patterns::Anything(),
          "Bodies with nodes of their own, separated by commas; "
          "all solids if empty. Those not named share theirs. "
          "Units: none.");
        prm.add_action("Bodies",
                       [&chosen,
                        bodies = names.bodies](const std::string &text) {
                         chosen.clear();
                         for (const auto &item : split_list(text))
                           chosen.push_back(index_of(item, bodies, "body"));
                       });
        prm.add_parameter(
          "Penalty",
          penalty,
          "How many times stiffer the contact is than a cell of "
          "the bodies: about one part in so many of the speed "
          "of approach is left. Units: none.",
          Patterns::Double(1., 1e6));
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (scene.approximation != Approximation::lme_mpm)
          fail(scene,
               "Effects",
               "'contact' is there with 'Approximation' = 'lme mpm' only");
        if (!scene.inertia)
          fail(scene,
               "Effects",
               "'contact' needs the effect 'inertia': a static body that "
               "nothing touches has no equilibrium");
        if (scene.adaptivity)
          fail(scene,
               "Effects",
               "'contact' and 'adaptivity' do not go together");
        if (scene.has_pressure())
          fail(scene,
               "Effects",
               "'contact' is between solids that are not mixed: it does not go "
               "with fluids or 'mixed pressure'");
        if (scene.n_layers() < 2)
          fail_without_need(scene,
                            "contact",
                            "Contact/Bodies",
                            "a single body");
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &scene) const override
      {
        double slowest = std::numeric_limits<double>::max();
        for (const auto &body : scene.bodies)
          slowest = std::min(slowest, body.law->sound_speed());
        return std::make_shared<ContactTerm<dim>>(penalty, slowest);
      }

    private:
      double penalty = 1000.;
    };
  } // namespace

  EffectRow
  contact_effect()
  {
    return effect_row<ContactEffect>(
      "contact",
      "Contact",
      "Bodies with nodes of their own, which push each other without friction "
      "and part freely.",
      "a node more at every vertex of the mesh for each body");
  }
} // namespace selkie
