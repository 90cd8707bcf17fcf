#include <selkie/particles/fields.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/terms/effect_table.h>

#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// A wall of linear springs behind a face of a body (Winkler's foundation):
    /// the layer of points at the face is drawn back to where it started,
    ///   R_a = sum_p k A_p N_a (x - X),  K_ab = sum_p k A_p N_a N_b I,
    /// with the reference area A_p = V_0 / spacing of a point.
    template <int dim>
    class SpringFoundationTerm : public Term<dim>
    {
    public:
      SpringFoundationTerm(const unsigned int body,
                           const unsigned int axis,
                           const double       plane,
                           const double       stiffness)
        : body(body)
        , axis(axis)
        , plane(plane)
        , k(stiffness)
      {}

      std::string
      name() const override
      {
        return "spring foundation";
      }

      TermUse
      use() const override
      {
        TermUse use;
        use.increment = true;
        use.source    = true;
        use.mass      = true;
        use.energy    = true;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.matter;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const double kA = spring(state.point(q));
            state.forms[q].source +=
              kA * (elongation(state.point(q)) + state.increment[q]);
            if (with_tangent)
              state.forms[q].mass += kA;
          }
      }

      double
      external_work(const PatchState<dim> &state) const override
      {
        double work = 0.;
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          work -= spring(state.point(q)) *
                  (elongation(state.point(q)) + 0.5 * state.increment[q]) *
                  state.increment[q];
        return work;
      }

    private:
      /// k A_p of the points of the layer, zero for the others (N/m).
      double
      spring(const StepPoint<dim> &point) const
      {
        const double spacing = std::pow(point.volume, 1. / dim);
        const bool   at_face =
          point.body == body && std::abs(point.X[axis] - plane) < spacing;
        return at_face ? k * point.volume / spacing : 0.;
      }

      static Tensor<1, dim>
      elongation(const StepPoint<dim> &point)
      {
        return point.x - point.X;
      }

      const unsigned int body, axis;
      const double       plane, k;
    };


    template <int dim>
    class SpringFoundationEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &names,
              Scene<dim> &) override
      {
        add_index(prm,
                  "Body",
                  body,
                  names.bodies,
                  "body",
                  "The body that rests on the springs; the default is the "
                  "first one. Units: none.");
        add_index(prm,
                  "Face",
                  face,
                  wall_names<dim>(),
                  "face",
                  "Which face of its bounding box does: left, right, bottom, "
                  "top, front, back. Units: none.");
        prm.add_parameter("Stiffness",
                          stiffness,
                          "Of the springs, per area of the face. Units: Pa/m.",
                          Patterns::Double(0.));
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (stiffness == 0.)
          fail_without_need(scene,
                            "spring foundation",
                            "Spring foundation/Stiffness",
                            "a stiffness of zero");
      }

      void
      add_columns(const Scene<dim> &, ParticleFields &fields) const override
      {
        fields.add<Tensor<1, dim>>("reference position", "m", true);
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &scene) const override
      {
        const auto box = scene.bodies[body].shape->bounding_box();
        return std::make_shared<SpringFoundationTerm<dim>>(
          body,
          face / 2,
          face % 2 == 0 ? box.lower_bound(face / 2) : box.upper_bound(face / 2),
          stiffness);
      }

    private:
      unsigned int body = 0, face = 0;
      double       stiffness = 1e6; ///< Pa/m
    };
  } // namespace

  EffectRow
  spring_foundation_effect()
  {
    return effect_row<SpringFoundationEffect>(
      "spring foundation",
      "Spring foundation",
      "A face of a body rests on a wall of linear springs.",
      "a spring at every point in every residual");
  }
} // namespace selkie
