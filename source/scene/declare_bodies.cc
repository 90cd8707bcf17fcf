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
      prm.declare_entry("Initial pressure",
                        "",
                        Patterns::Anything(),
                        "Of a fluid, which starts with the volume ratio that "
                        "belongs to it: a function of X, Y, Z; that of the "
                        "volume ratio 1 if empty. Units: Pa.");
      prm.add_action("Initial pressure", [&body](const std::string &text) {
        body.initial_pressure =
          text.empty() ? nullptr : std::make_shared<Expression>(text);
      });
      declare_law(prm, law, viscous);
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
  }


  template void
  declare_bodies(ParameterHandler &, const SceneNames &, Scene<2> &);
  template void
  declare_bodies(ParameterHandler &, const SceneNames &, Scene<3> &);
} // namespace selkie
