#include <selkie/scene/check_scene.h>
#include <selkie/terms/effect_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// R_a = -sum_p m N_a g, on the material points in every cell.
    template <int dim>
    class GravityTerm : public Term<dim>
    {
    public:
      explicit GravityTerm(const Tensor<1, dim> &g)
        : g(g)
      {}

      std::string
      name() const override
      {
        return "gravity";
      }

      TermUse
      use() const override
      {
        TermUse use;
        use.source = true;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.matter;
      }

      void
      add(PatchState<dim> &state, const bool) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          state.forms[q].source -= state.point(q).mass * g;
      }

      double
      acceleration_scale() const override
      {
        return g.norm();
      }

    private:
      const Tensor<1, dim> g;
    };


    template <int dim>
    class GravityEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &,
              Scene<dim> &scene) override
      {
        Tensor<1, dim> &g = scene.gravity.emplace();
        g[1]              = -9.81;
        prm.add_parameter("Acceleration",
                          g,
                          "The acceleration of free fall. Units: m/s^2.");
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (scene.gravity->norm() == 0)
          fail_without_need(scene,
                            "gravity",
                            "Gravity/Acceleration",
                            "an acceleration of zero");
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &scene) const override
      {
        return std::make_shared<GravityTerm<dim>>(*scene.gravity);
      }
    };
  } // namespace

  EffectRow
  gravity_effect()
  {
    return effect_row<GravityEffect>(
      "gravity",
      "Gravity",
      "A constant acceleration on all bodies.",
      "the weight of every point in every residual");
  }
} // namespace selkie
