#include <selkie/particles/fields.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/terms/dead_load.h>
#include <selkie/terms/effect_table.h>

#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// R_a = -sum_p A_p N_a t(X, x, t); A_p is the face's reference area that a
    /// point carries (a dead load): of the outermost material points of a body,
    /// or of the Gauss points of finite elements' faces.
    template <int dim>
    class TractionTerm : public DeadLoad<dim>
    {
    public:
      explicit TractionTerm(const std::vector<Traction<dim>> &tractions)
        : tractions(tractions)
      {}

      std::string
      name() const override
      {
        return "traction";
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.matter || (kind.surface && !kind.fluid);
      }

    private:
      Tensor<1, dim>
      load(const PatchState<dim> &state, const unsigned int q) const override
      {
        const StepPoint<dim> &point = state.point(q);
        Tensor<1, dim>        sum;
        if (point.area != 0.)
          for (const auto &traction : tractions)
            if (traction.body == point.body)
              sum += point.area *
                     traction.value->value(point.x, state.time->t(), point.X);
        return sum;
      }

      const std::vector<Traction<dim>> tractions;
    };


    template <int dim>
    void
    declare_traction(ParameterHandler  &prm,
                     const SceneNames  &names,
                     const std::string &name,
                     Traction<dim>     &traction)
    {
      traction.name = name;
      prm.enter_subsection(name);
      add_index(prm,
                "Body",
                traction.body,
                names.bodies,
                "body",
                "The loaded body, a solid that fills a box; the default is the "
                "first one. Units: none.");
      add_index(prm,
                "Face",
                traction.face,
                wall_names<dim>(),
                "face",
                "Which face of that box: left, right, bottom, top, front, "
                "back. Units: none.");
      add_function(prm,
                   "Value",
                   traction.value,
                   "Force per reference area: one function of X, Y, Z, x, y, "
                   "z, t per component, separated by semicolons. Units: Pa.");
      prm.leave_subsection();
    }


    template <int dim>
    void
    check_traction(const Scene<dim> &scene, const Traction<dim> &traction)
    {
      const std::string path = "Tractions/" + traction.name + "/";
      if (!traction.value)
        fail(scene, path + "Value", "the load needs a function");
      for (const auto &other : scene.tractions)
        if (&other != &traction && other.body == traction.body)
          fail(scene,
               path + "Body",
               "a body takes one traction; '" + other.name +
                 "' acts on the same body");
      const Body<dim> &body = scene.bodies[traction.body];
      if (body.phase == 0)
        fail(scene,
             path + "Body",
             "a traction acts on a solid, and '" + body.name + "' is a fluid");
      const double box = body.shape->bounding_box().volume();
      // Finite elements have faces; points are those next to a plane one.
      if (!scene.lagrangian_mesh() &&
          std::abs(body.shape->volume() - box) > 1e-10 * box)
        fail(scene,
             path + "Body",
             "a traction acts on a face of a box, and the shape of '" +
               body.name + "' is no box");
    }


    template <int dim>
    class TractionEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &names,
              Scene<dim>       &scene) override
      {
        prm.declare_entry("Names",
                          "",
                          Patterns::Anything(),
                          "Names of the loads, separated by commas; each is a "
                          "subsection. Units: none.");
        scene.tractions.resize(names.tractions.size());
        for (unsigned int i = 0; i < names.tractions.size(); ++i)
          declare_traction(prm, names, names.tractions[i], scene.tractions[i]);
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (scene.tractions.empty())
          fail(scene,
               "Tractions/Names",
               "the effect 'traction' is listed without a load");
        for (const auto &traction : scene.tractions)
          check_traction(scene, traction);
      }

      void
      add_columns(const Scene<dim> &scene,
                  ParticleFields   &fields) const override
      {
        fields.add<Tensor<1, dim>>("reference position", "m", true);
        if (!scene.lagrangian_mesh()) // there faces of elements are loaded
          fields.add<double>("traction area",
                             dim == 2 ? "m" : "m^2",
                             false,
                             Combine::sum);
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &scene) const override
      {
        return std::make_shared<TractionTerm<dim>>(scene.tractions);
      }
    };
  } // namespace

  EffectRow
  traction_effect()
  {
    return effect_row<TractionEffect>(
      "traction",
      "Tractions",
      "Dead loads on faces of box-shaped bodies.",
      "a load at every point in every residual");
  }
} // namespace selkie
