#include <selkie/particles/fields.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/terms/dead_load.h>
#include <selkie/terms/effect_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// R_a = -sum_p m N_a b(X, x, t). A dead load.
    template <int dim>
    class BodyForceTerm : public DeadLoad<dim>
    {
    public:
      explicit BodyForceTerm(std::shared_ptr<VectorExpression<dim>> force)
        : force(std::move(force))
      {}

      std::string
      name() const override
      {
        return "body force";
      }

    private:
      Tensor<1, dim>
      load(const PatchState<dim> &state, const unsigned int q) const override
      {
        const StepPoint<dim> &point = state.point(q);
        return point.mass * force->value(point.x, state.time->t(), point.X);
      }

      const std::shared_ptr<VectorExpression<dim>> force;
    };


    template <int dim>
    class BodyForceEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm, const SceneNames &, Scene<dim> &) override
      {
        add_function(prm,
                     "Acceleration",
                     force,
                     "One function of X, Y, Z, x, y, z, t per component, "
                     "separated by semicolons. Units: m/s^2.");
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (!force)
          fail(scene,
               "Body force/Acceleration",
               "the effect 'body force' is listed without its function");
      }

      void
      add_columns(const Scene<dim> &, ParticleFields &fields) const override
      {
        fields.add<Tensor<1, dim>>("reference position", "m", true);
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &) const override
      {
        return std::make_shared<BodyForceTerm<dim>>(force);
      }

    private:
      std::shared_ptr<VectorExpression<dim>> force; ///< m/s^2, of X, x, t
    };
  } // namespace

  EffectRow
  body_force_effect()
  {
    return effect_row<BodyForceEffect>(
      "body force",
      "Body force",
      "An acceleration that is a function of X, x and t.",
      "a muParser function at every point in every residual");
  }
} // namespace selkie
