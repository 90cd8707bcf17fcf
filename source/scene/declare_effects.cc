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
    using Patterns::Double;

    void
    declare_inertia(ParameterHandler &prm, Inertia &inertia)
    {
      prm.enter_subsection("Inertia");
      add_choice(prm,
                 "Mass",
                 inertia.mass,
                 {{"automatic", MassKind::automatic},
                  {"lumped", MassKind::lumped},
                  {"consistent", MassKind::consistent}},
                 "The mass matrix; `automatic` is consistent for `q4 fem` and "
                 "lumped for material points. Units: none.");
      prm.add_parameter("Newmark beta",
                        inertia.newmark_beta,
                        "Newmark's beta, at least gamma / 2; (gamma + 1/2)^2 / "
                        "4 damps best. Units: none.",
                        Double(0., 1.));
      prm.add_parameter("Newmark gamma",
                        inertia.newmark_gamma,
                        "Newmark's gamma: 0.5 keeps energy, 0.6 damps what is "
                        "faster than the step. Units: none.",
                        Double(0.5, 1.));
      prm.leave_subsection();
    }


    template <int dim>
    void
    declare_gravity(ParameterHandler &prm, Tensor<1, dim> &gravity)
    {
      gravity[1] = -9.81;
      prm.enter_subsection("Gravity");
      prm.add_parameter("Acceleration",
                        gravity,
                        "The acceleration of free fall. Units: m/s^2.");
      prm.leave_subsection();
    }


    void
    declare_fluid_pressure(ParameterHandler &prm, FluidPressure &pressure)
    {
      prm.enter_subsection("Fluid pressure");
      prm.add_parameter("Stabilisation",
                        pressure.ppp_alpha,
                        "Factor alpha of the polynomial pressure projection. "
                        "Units: none.",
                        Double(0.));
      prm.add_parameter("Volume correction",
                        pressure.volume_kappa,
                        "Share of the excess of crowded points' volume that is "
                        "corrected in a step. Units: none.",
                        Double(0., 1.));
      prm.add_parameter("Volume deadband",
                        pressure.volume_deadband,
                        "Relative excess that is not corrected. Units: none.",
                        Double(0.));
      prm.add_parameter("Gauss points in full cells",
                        pressure.gauss_full_cells,
                        "Whether cells in the interior of the fluid are "
                        "integrated at fixed Gauss points instead of at the "
                        "material points. Units: none.");
      prm.leave_subsection();
    }


    /// The index of `text` in `names`.
    unsigned int
    index_of(const std::string              &text,
             const std::vector<std::string> &names,
             const std::string              &what)
    {
      std::string known;
      for (unsigned int i = 0; i < names.size(); ++i)
        {
          if (names[i] == text)
            return i;
          known += (known.empty() ? "" : ", ") + names[i];
        }
      throw SceneError("there is no such " + what + "; allowed are: " + known);
    }


    /// A parameter whose value is one of some names; the first one is default.
    void
    add_index(ParameterHandler               &prm,
              const std::string              &name,
              unsigned int                   &variable,
              const std::vector<std::string> &names,
              const std::string              &what,
              const std::string              &documentation)
    {
      prm.declare_entry(name,
                        names.empty() ? "" : names[0],
                        Patterns::Anything(),
                        documentation);
      prm.add_action(name, [&variable, names, what](const std::string &text) {
        if (!text.empty() || !names.empty())
          variable = index_of(text, names, what);
      });
    }


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
    declare_probe(ParameterHandler  &prm,
                  const SceneNames  &names,
                  const std::string &name,
                  Probe<dim>        &probe)
    {
      using Kind     = typename Probe<dim>::Kind;
      using Quantity = typename Probe<dim>::Quantity;
      probe.name     = name;
      prm.enter_subsection(name);
      add_choice(
        prm,
        "Kind",
        probe.kind,
        {{"point", Kind::point},
         {"node", Kind::node},
         {"region", Kind::region},
         {"wall force", Kind::wall_force},
         {"front", Kind::front},
         {"extent", Kind::extent},
         {"error", Kind::error}},
        "`point` is the mean of the material points that start within "
        "Radius of Position, `node` the node of a finite element mesh "
        "(`q4 fem`) that starts nearest to Position, `region` of those that start in Shape, "
        "`wall force` the reaction of Wall, `front` the largest "
        "coordinate along Axis that Body reaches, `extent` the "
        "smallest and largest coordinates, volume and centroid of "
        "Body, `error` how far Body's Quantity is from Function: the norm "
        "over the body's points, weighted with their reference volumes, and "
        "the largest. Units: none.");
      prm.add_parameter("Position",
                        probe.position,
                        "For `point` and `node`. Units: m.");
      prm.add_parameter("Radius",
                        probe.radius,
                        "For `point`; 0 means one cell. Units: m.",
                        Double(0.));
      add_shape(prm,
                "Shape",
                probe.shape,
                "For `region`; written as a body's shape. Units: m.");
      add_index(prm,
                "Wall",
                probe.wall,
                wall_names<dim>(),
                "wall",
                "For `wall force`: left, right, bottom, top, front, back. "
                "Units: none.");
      add_index(prm,
                "Body",
                probe.body,
                names.bodies,
                "body",
                "For `front`, `extent` and `error`; the default is the first "
                "one. Units: none.");
      add_choice<unsigned int>(
        prm,
        "Axis",
        probe.axis,
        dim == 2 ? std::vector<std::pair<std::string, unsigned int>>{{"x", 0},
                                                                     {"y", 1}}
                 : std::vector<std::pair<std::string, unsigned int>>{{"x", 0},
                                                                     {"y", 1},
                                                                     {"z", 2}},
        "For `front`. Units: none.");
      add_choice(prm,
                 "Quantity",
                 probe.quantity,
                 {{"displacement", Quantity::displacement},
                  {"velocity", Quantity::velocity}},
                 "For `error`. Units: none.");
      add_function(prm,
                   "Function",
                   probe.function,
                   "For `error`, what Quantity should be: one function of X, "
                   "Y, Z, x, y, z, t per component, separated by semicolons. "
                   "Units: m or m/s.");
      prm.leave_subsection();
    }


    template <int dim>
    void
    declare_tractions(ParameterHandler &prm,
                      const SceneNames &names,
                      Scene<dim>       &scene)
    {
      prm.enter_subsection("Tractions");
      prm.declare_entry("Names",
                        "",
                        Patterns::Anything(),
                        "Names of the loads, separated by commas; each is a "
                        "subsection. Units: none.");
      scene.tractions.resize(names.tractions.size());
      for (unsigned int i = 0; i < names.tractions.size(); ++i)
        declare_traction(prm, names, names.tractions[i], scene.tractions[i]);
      prm.leave_subsection();
    }


    template <int dim>
    void
    declare_probes(ParameterHandler &prm,
                   const SceneNames &names,
                   Scene<dim>       &scene)
    {
      prm.enter_subsection("Probes");
      prm.declare_entry("Names",
                        "",
                        Patterns::Anything(),
                        "Names of the curves, separated by commas; each is a "
                        "subsection and a file probes/NAME.csv. Units: none.");
      prm.add_parameter("Interval",
                        scene.output.probe_interval,
                        "Time between two rows; 0 for every step. Units: s.",
                        Double(0.));
      scene.probes.resize(names.probes.size());
      for (unsigned int i = 0; i < names.probes.size(); ++i)
        declare_probe(prm, names, names.probes[i], scene.probes[i]);
      prm.leave_subsection();
    }


    template <int dim>
    void
    declare_body_force(ParameterHandler &prm, Scene<dim> &scene)
    {
      prm.enter_subsection("Body force");
      add_function(prm,
                   "Acceleration",
                   scene.body_force,
                   "One function of X, Y, Z, x, y, z, t per component, "
                   "separated by semicolons. Units: m/s^2.");
      prm.leave_subsection();
    }


    template <int dim>
    void
    declare_hydrostatic_start(ParameterHandler &prm,
                              const SceneNames &names,
                              Scene<dim>       &scene)
    {
      prm.enter_subsection("Hydrostatic start");
      prm.declare_entry("Bodies",
                        "",
                        Patterns::Anything(),
                        "Fluids that start compressed by their own weight, "
                        "with the surface at their highest point, separated "
                        "by commas; all fluids if empty. Units: none.");
      prm.add_action("Bodies", [&scene, &names](const std::string &text) {
        for (auto &body : scene.bodies)
          body.hydrostatic_start = false;
        for (const auto &item : split_list(text))
          scene.bodies[index_of(item, names.bodies, "body")].hydrostatic_start =
            true;
      });
      prm.leave_subsection();
    }
  } // namespace


  template <int dim>
  void
  declare_effects(ParameterHandler &prm,
                  const SceneNames &names,
                  Scene<dim>       &scene)
  {
    scene.effects         = names.effects;
    scene.viscosity       = names.has_effect("viscosity");
    scene.mean_dilatation = names.has_effect("mean dilatation");
    if (names.has_effect("inertia"))
      declare_inertia(prm, scene.inertia.emplace());
    if (names.has_effect("gravity"))
      declare_gravity(prm, scene.gravity.emplace());
    if (names.has_effect("body force"))
      declare_body_force(prm, scene);
    if (names.has_effect("traction"))
      declare_tractions(prm, names, scene);
    if (names.has_effect("hydrostatic start"))
      declare_hydrostatic_start(prm, names, scene);
    if (names.has_effect("probes"))
      declare_probes(prm, names, scene);
    if (names.has_fluid())
      declare_fluid_pressure(prm, scene.fluid_pressure.emplace());
  }


  template void
  declare_effects(ParameterHandler &, const SceneNames &, Scene<2> &);
  template void
  declare_effects(ParameterHandler &, const SceneNames &, Scene<3> &);
} // namespace selkie
