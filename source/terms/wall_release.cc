#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/terms/effect_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Walls that push bodies but do not hold them. The conditions at the
    /// nodes change in the course of a step (assembly/node_release), so there
    /// is no term.
    template <int dim>
    class WallReleaseEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &names,
              Scene<dim>       &scene) override
      {
        WallRelease<dim> &release = scene.release.emplace();
        add_walls<dim>(prm,
                       release.walls,
                       "Slip and fixed walls that let go, separated by commas; "
                       "all of them if empty. Units: none.");
        prm.declare_entry("Bodies",
                          "",
                          Patterns::Anything(),
                          "Bodies that may leave them, separated by commas; "
                          "all solids if empty. Units: none.");
        prm.add_action(
          "Bodies", [&release, bodies = names.bodies](const std::string &text) {
            release.bodies.clear();
            for (const auto &item : split_list(text))
              release.bodies.push_back(index_of(item, bodies, "body"));
          });
      }

      void
      check(const Scene<dim> &scene) const override
      {
        if (scene.lagrangian_mesh())
          fail(scene,
               "Effects",
               "'wall release' is about nodes of the background mesh, and "
               "'Approximation' = 'q4 fem' has none");
        if (!scene.inertia)
          fail(scene,
               "Effects",
               "'wall release' needs the effect 'inertia': a static body that "
               "is let go has no equilibrium");
        check_walls(scene,
                    "Wall release/Walls",
                    scene.release->walls,
                    {NodeCondition::slip, NodeCondition::fixed});
        bool solid = false;
        for (const auto &body : scene.bodies)
          solid = solid || body.law->phase() == Phase::solid;
        if (scene.release->bodies.empty() && !solid)
          fail(scene,
               "Wall release/Bodies",
               "the scene has no solid; name the fluids that may leave the "
               "walls");
      }
    };
  } // namespace

  EffectRow
  wall_release_effect()
  {
    return effect_row<WallReleaseEffect>(
      "wall release",
      "Wall release",
      "Walls push the bodies but do not hold them.",
      "a look at the walls' reactions after every step, and Newton again where "
      "one pulls");
  }
} // namespace selkie
