#include <selkie/assembly/node_conditions.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/terms/effect_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Walls of the domain's box that hold the nodes on them: contact without
    /// friction (`slip`), with perfect friction (`fixed`), or with a wall that
    /// moves (`prescribed`). What each does is a parameter of the domain; a
    /// scene whose walls are all free has no such effect.
    template <int dim>
    class WallContact : public Effect<dim>
    {
    public:
      void
      hold(const Scene<dim> &scene,
           const NodeCloud<dim> & /*cloud*/,
           const double /*t*/,
           NodeConditions<dim> &conditions) const override
      {
        for (unsigned int w = 0; w < 2 * dim; ++w)
          {
            const Wall<dim>                     &wall = scene.domain.walls[w];
            typename NodeConditions<dim>::Motion motion;
            if (wall.condition == NodeCondition::prescribed)
              motion = [velocity = wall.velocity](const Point<dim> &x,
                                                  const double      time) {
                return velocity->value(x, time, x);
              };
            conditions.hold_wall(w, wall.components, motion);
          }
      }
    };
  } // namespace

  EffectRow
  wall_contact_effect()
  {
    EffectRow row = effect_row<WallContact>(
      "wall contact",
      "",
      "Walls of the domain that hold the nodes on them. Comes with every wall "
      "that is not `free`.",
      "nothing in any loop: held nodes have smaller systems");
    row.comes_with = [](const SceneNames &names) {
      return names.holding_walls;
    };
    return row;
  }
} // namespace selkie
