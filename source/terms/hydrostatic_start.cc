#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/laws/fluid_law.h>
#include <selkie/particles/particle_set.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/terms/effect_table.h>

#include <limits>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Gives the points of fluids the pressure rho g depth, below the highest
    /// point of their body, and the volume ratio that belongs to it.
    template <int dim>
    class HydrostaticStart : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &names,
              Scene<dim> &) override
      {
        prm.declare_entry("Bodies",
                          "",
                          Patterns::Anything(),
                          "Fluids that start compressed by their own weight, "
                          "with the surface at their highest point, separated "
                          "by commas; all fluids if empty. Units: none.");
        prm.add_action("Bodies",
                       [this, bodies = names.bodies](const std::string &text) {
                         chosen.clear();
                         for (const auto &item : split_list(text))
                           chosen.push_back(index_of(item, bodies, "body"));
                       });
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (!scene.gravity)
          fail(scene,
               "Effects",
               "'hydrostatic start' needs the effect 'gravity'");
        if (!scene.has_fluid())
          fail(scene,
               "Effects",
               "'hydrostatic start' needs a fluid, and no body of the scene "
               "has a fluid's law");
        for (const unsigned int b : chosen)
          if (scene.bodies[b].law->phase() != Phase::fluid)
            fail(scene,
                 "Hydrostatic start/Bodies",
                 "the body '" + scene.bodies[b].name +
                   "' is not a fluid; allowed are the scene's fluids");
        for (unsigned int b = 0; b < scene.bodies.size(); ++b)
          if (scene.bodies[b].initial_pressure && starts(b))
            fail(scene,
                 "Bodies/" + scene.bodies[b].name + "/Initial pressure",
                 "'hydrostatic start' gives the body another one; allowed are "
                 "fluids that 'Hydrostatic start/Bodies' does not name");
      }

      void
      start(ParticleSet<dim> &particles) const override
      {
        const auto &scene   = particles.scene;
        const auto &columns = particles.columns;
        fail_together<SceneError>(particles.communicator(), [&] {
          for (auto &particle : particles.handler())
            {
              const auto properties = particle.get_properties();
              const auto b =
                static_cast<unsigned int>(columns.body(properties));
              const Body<dim> &body = scene.bodies[b];
              const auto *law = dynamic_cast<const FluidLaw *>(body.law.get());
              if (law == nullptr || !starts(b))
                continue;
              const double p =
                law->density() *
                (*scene.gravity * Tensor<1, dim>(particle.get_location()) -
                 top_level(body.shape->bounding_box(), *scene.gravity));
              columns.pressure.set(properties, p);
              columns.J.set(properties, volume_ratio(scene, body, *law, p));
            }
        });
      }

    private:
      /// At the pressure p (Pa).
      static double
      volume_ratio(const Scene<dim> &scene,
                   const Body<dim>  &body,
                   const FluidLaw   &law,
                   const double      p)
      {
        try
          {
            return law.J_of_pressure(p);
          }
        catch (const NumericalFailure &failure)
          {
            fail(scene,
                 "Bodies/" + body.name + "/Law parameters/Reference pressure",
                 "'hydrostatic start' starts from 0 Pa at the surface; " +
                   std::string(failure.what()));
          }
      }

      bool
      starts(const unsigned int body) const
      {
        return chosen.empty() ||
               std::find(chosen.begin(), chosen.end(), body) != chosen.end();
      }

      std::vector<unsigned int> chosen; ///< bodies; empty: all fluids
    };
  } // namespace

  EffectRow
  hydrostatic_start_effect()
  {
    return effect_row<HydrostaticStart>(
      "hydrostatic start",
      "Hydrostatic start",
      "Fluids start compressed by their own weight.",
      "one pass over the points at the start");
  }
} // namespace selkie
