#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/terms/effect_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Navier's friction of fluids on slip walls: the wall draws with the force
    /// -beta v per area, so R_a = int beta N_a v dA over the wetted walls and
    /// K_ab = int beta alpha4 N_a N_b I dA. The wall holds the normal velocity,
    /// so what is left of v is tangential. The slip length is mu / beta.
    template <int dim>
    class WallFrictionTerm : public Term<dim>
    {
    public:
      explicit WallFrictionTerm(const double beta)
        : beta(beta)
      {}

      std::string
      name() const override
      {
        return "wall friction";
      }

      TermUse
      use() const override
      {
        TermUse use;
        use.velocity = true;
        use.source   = true;
        use.mass     = true;
        use.energy   = true;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.surface && kind.fluid;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const double friction = beta * state.point(q).area;
            state.forms[q].source += friction * state.velocity[q];
            if (with_tangent)
              state.forms[q].mass += friction * state.time->newmark.alpha4;
          }
      }

      double
      dissipation(const PatchState<dim> &state) const override
      {
        double power = 0.;
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          power += beta * state.point(q).area * state.velocity[q].norm_square();
        return power;
      }

    private:
      const double beta; ///< Pa s/m
    };


    template <int dim>
    class WallFrictionEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &,
              Scene<dim> &scene) override
      {
        add_walls<dim>(prm,
                       scene.wall_points.emplace(),
                       "Slip walls that rub, separated by commas; all slip "
                       "walls if empty. Units: none.");
        prm.add_parameter("Coefficient",
                          beta,
                          "Force per area and velocity; the slip length is the "
                          "viscosity over it. Units: Pa s/m.",
                          Patterns::Double(0.));
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (!scene.has_fluid())
          fail(scene,
               "Effects",
               "'wall friction' needs a fluid, and no body of the scene has a "
               "fluid's law");
        if (scene.approximation != Approximation::lme_mpm)
          fail(scene,
               "Effects",
               "'wall friction' is there with 'Approximation' = 'lme mpm' "
               "only");
        check_walls(scene,
                    "Wall friction/Walls",
                    *scene.wall_points,
                    {NodeCondition::slip});
        if (beta == 0.)
          fail_without_need(scene,
                            "wall friction",
                            "Wall friction/Coefficient",
                            "a coefficient of zero");
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &) const override
      {
        return std::make_shared<WallFrictionTerm<dim>>(beta);
      }

    private:
      double beta = 1.; ///< Pa s/m
    };
  } // namespace

  EffectRow
  wall_friction_effect()
  {
    return effect_row<WallFrictionEffect>(
      "wall friction",
      "Wall friction",
      "Navier's friction of fluids on slip walls.",
      "shape functions at Gauss points of every wetted wall face");
  }
} // namespace selkie
