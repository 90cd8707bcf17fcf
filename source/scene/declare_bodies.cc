#include <selkie/base/exceptions.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/scene/parameter_file.h>

#include <deal.II/base/patterns.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The parameters of a law. Without the effect `viscosity` fluids have
    /// none, whatever the law's default.
    void
    declare_law(ParameterHandler &prm, const LawRow &law, const bool viscous)
    {
      prm.enter_subsection("Law parameters");
      law.declare(prm);
      ParameterHandler alone;
      law.declare(alone);
      for (const auto &parameter : declared_parameters(alone))
        if (parameter.path == "Viscosity" && !viscous)
          prm.set("Viscosity", "0");
      prm.leave_subsection();
    }


    template <int dim>
    void
    declare_body(ParameterHandler  &prm,
                 const LawRow      &law,
                 const bool         viscous,
                 const std::string &name,
                 Body<dim>         &body)
    {
      body.name = name;
      prm.enter_subsection(name);
      prm.declare_entry("Law",
                        law.name,
                        Patterns::Selection(law_names()),
                        "What the body is made of; its constants are in the "
                        "subsection `Law parameters`. Units: none.");
      add_shape(prm,
                "Shape",
                body.shape,
                "What the body covers at the start: box(x0, y0, x1, y1), "
                "disc(x, y, r), polygon(x0, y0, x1, y1, ...), inside(x0, y0, "
                "x1, y1, expression); in 3D box(x0, y0, z0, x1, y1, z1), "
                "sphere(x, y, z, r), inside(x0, y0, z0, x1, y1, z1, "
                "expression); joined by + and - from left to right, with "
                "parentheses. Units: m.");
      prm.add_parameter("Points per direction",
                        body.points_per_direction,
                        "Material points of a full cell in each direction. "
                        "Units: none.",
                        Patterns::Integer(1, 20));
      prm.add_parameter("Jitter",
                        body.jitter,
                        "Random displacement of the points at the start, as a "
                        "fraction of their spacing. Units: none.",
                        Patterns::Double(0., 0.5));
      add_function(prm,
                   "Initial velocity",
                   body.initial_velocity,
                   "One function of x, y, z per component, separated by "
                   "semicolons; at rest if empty. Units: m/s.");
      add_function(prm,
                   "Initial displacement",
                   body.initial_displacement,
                   "Of the points of a fluid from their lattice to where they "
                   "start, at no cost of volume: one function of X, Y, Z per "
                   "component, separated by semicolons; e.g. a wave. Units: "
                   "m.");
      declare_law(prm, law, viscous);
      prm.leave_subsection();
    }


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
  } // namespace


  template <int dim>
  void
  declare_bodies(ParameterHandler &prm,
                 const SceneNames &names,
                 Scene<dim>       &scene)
  {
    prm.enter_subsection("Bodies");
    prm.declare_entry("Names",
                      "",
                      Patterns::Anything(),
                      "Names of the bodies, separated by commas; each is a "
                      "subsection. Units: none.");
    scene.bodies.resize(names.bodies.size());
    for (unsigned int i = 0; i < names.bodies.size(); ++i)
      declare_body(prm,
                   *names.laws[i],
                   names.has_effect("viscosity"),
                   names.bodies[i],
                   scene.bodies[i]);
    prm.leave_subsection();

    prm.enter_subsection("Node sets");
    prm.declare_entry("Names",
                      "",
                      Patterns::Anything(),
                      "Names of sets of nodes that are held or moved, "
                      "separated by commas; each is a subsection. "
                      "Units: none.");
    scene.node_sets.resize(names.node_sets.size());
    for (unsigned int i = 0; i < names.node_sets.size(); ++i)
      declare_node_set(prm, names.node_sets[i], scene.node_sets[i]);
    prm.leave_subsection();
  }


  template void
  declare_bodies(ParameterHandler &, const SceneNames &, Scene<2> &);
  template void
  declare_bodies(ParameterHandler &, const SceneNames &, Scene<3> &);
} // namespace selkie
