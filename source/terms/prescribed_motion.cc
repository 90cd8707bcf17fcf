#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/terms/effect_table.h>

namespace selkie
{
  namespace
  {
    /// Walls and node sets that move. Their velocities are parameters of the
    /// walls and sets; the nodes take them as conditions (assembly/
    /// node_conditions), so there is no term.
    template <int dim>
    class PrescribedMotion : public Effect<dim>
    {
    public:
      void
      check(const Scene<dim> &scene) const override
      {
        bool moves = false;
        for (const auto &wall : scene.domain.walls)
          moves = moves || wall.condition == NodeCondition::prescribed;
        for (const auto &set : scene.node_sets)
          moves = moves || set.condition != NodeCondition::fixed;
        if (!moves)
          fail(scene,
               "Effects",
               "'prescribed motion' is listed, and no wall is 'prescribed' and "
               "no node set 'prescribed' or 'moving'");
      }
    };


    /// A velocity of a wall or of a node set, or a path.
    bool
    is_velocity(const ParameterEntry &entry)
    {
      const auto &sections = entry.sections;
      const bool  of_set   = !sections.empty() && sections[0] == "Node sets" &&
                          (entry.name == "Velocity" || entry.name == "Path");
      const bool of_wall = sections.size() == 2 && sections[1] == "Walls" &&
                           entry.name.find(" velocity") != std::string::npos;
      return (of_set || of_wall) && !entry.value.empty();
    }
  } // namespace

  EffectRow
  prescribed_motion_effect()
  {
    EffectRow row = effect_row<PrescribedMotion>(
      "prescribed motion",
      "",
      "Walls and node sets that move with a given velocity.",
      "a velocity function at every held node in every step");
    row.claims = &is_velocity;
    return row;
  }
} // namespace selkie
