#include <selkie/assembly/node_conditions.h>
#include <selkie/base/exceptions.h>
#include <selkie/base/text.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/terms/effect_table.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// "x, y": which components a node set holds.
    template <int dim>
    void
    set_components(std::array<bool, dim> &components, const std::string &text)
    {
      components.fill(false);
      for (const auto &item : split_list(text))
        {
          const std::size_t d = std::string("xyz").find(item);
          if (item.size() != 1 || d >= dim)
            throw SceneError(std::string("allowed are x, y") +
                             (dim == 3 ? ", z" : "") + ", separated by commas");
          components[d] = true;
        }
    }


    template <int dim>
    void
    declare_node_set(ParameterHandler  &prm,
                     const std::string &name,
                     NodeSet<dim>      &set)
    {
      set.name = name;
      prm.enter_subsection(name);
      add_shape(prm,
                "Shape",
                set.shape,
                "The nodes of the background mesh inside it are held: a clamp, "
                "a piston, a rigid obstacle. Written as a body's shape. "
                "Units: m.");
      add_choice(prm,
                 "Condition",
                 set.condition,
                 {{"fixed", NodeCondition::fixed},
                  {"prescribed", NodeCondition::prescribed},
                  {"moving", NodeCondition::moving}},
                 "Held in place; moved with a velocity; or, for a shape that "
                 "moves through the mesh (a piston, a rigid obstacle), held to "
                 "the velocity of that shape. The last two need the effect "
                 "`prescribed motion`. Units: none.");
      prm.declare_entry("Components",
                        dim == 2 ? "x, y" : "x, y, z",
                        Patterns::Anything(),
                        "Which displacement components, separated by commas. "
                        "Units: none.");
      prm.add_action("Components", [&set](const std::string &text) {
        set_components<dim>(set.components, text);
      });
      add_function(prm,
                   "Velocity",
                   set.velocity,
                   "If `prescribed`: one function of x, y, z, t per component, "
                   "separated by semicolons. Units: m/s.");
      add_function(prm,
                   "Path",
                   set.path,
                   "If `moving`: how far the shape has moved from where it is "
                   "written, one function of t per component, separated by "
                   "semicolons. Units: m.");
      prm.leave_subsection();
    }


    template <int dim>
    void
    check_node_set(const Scene<dim> &scene, const NodeSet<dim> &set)
    {
      const std::string path = "Node sets/" + set.name + "/";
      if (!set.shape)
        fail(scene, path + "Shape", "the node set needs a shape");
      if (std::none_of(set.components.begin(),
                       set.components.end(),
                       [](const bool held) { return held; }))
        fail(scene,
             path + "Components",
             "the node set holds nothing; name at least one component");
      if (scene.domain.mesh)
        return;
      if (!has_node_inside(scene.domain, *set.shape))
        fail(scene,
             path + "Shape",
             "no node of the mesh lies in the node set; nodes are the corners "
             "of the cells, " +
               format("%g", cell_size(scene.domain)) +
               " m wide before refinement, from the domain's lower corner on");
    }


    /// Sets of nodes inside a shape that are held: a clamp, a rigid obstacle,
    /// a piston.
    template <int dim>
    class RigidObstacles : public Effect<dim>
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
                          "Names of sets of nodes that are held or moved, "
                          "separated by commas; each is a subsection. "
                          "Units: none.");
        scene.node_sets.resize(names.node_sets.size());
        for (unsigned int i = 0; i < names.node_sets.size(); ++i)
          declare_node_set(prm, names.node_sets[i], scene.node_sets[i]);
      }

      void
      check(const Scene<dim> &scene) const override
      {
        for (const auto &set : scene.node_sets)
          check_node_set(scene, set);
      }

      void
      hold(const Scene<dim>     &scene,
           const NodeCloud<dim> &cloud,
           const double          t,
           NodeConditions<dim>  &conditions) const override
      {
        for (const auto &set : scene.node_sets)
          {
            const Tensor<1, dim> moved = set.condition == NodeCondition::moving
                                           ? set.path->value(Point<dim>(), t)
                                           : Tensor<1, dim>();
            std::vector<unsigned int> inside;
            for (unsigned int node = 0; node < cloud.size(); ++node)
              if (set.shape->contains(cloud.position(node) - moved))
                inside.push_back(node);
            conditions.hold_nodes(inside, set.components, motion_of(set));
          }
      }

    private:
      static typename NodeConditions<dim>::Motion
      motion_of(const NodeSet<dim> &set)
      {
        if (set.condition == NodeCondition::prescribed)
          return
            [velocity = set.velocity](const Point<dim> &x, const double time) {
              return velocity->value(x, time, x);
            };
        if (set.condition == NodeCondition::moving)
          return [path = set.path](const Point<dim> &x, const double time) {
            constexpr double h = 1e-6; // s; central difference
            return (path->value(x, time + h) - path->value(x, time - h)) /
                   (2. * h);
          };
        return {};
      }
    };
  } // namespace

  EffectRow
  rigid_obstacles_effect()
  {
    EffectRow row = effect_row<RigidObstacles>(
      "rigid obstacles",
      "Node sets",
      "Nodes of the background mesh that are held: clamps, rigid obstacles, "
      "pistons. Comes with every node set.",
      "nothing in any loop; moving ones are looked for before every step");
    row.comes_with = [](const SceneNames &names) {
      return !names.node_sets.empty();
    };
    return row;
  }
} // namespace selkie
