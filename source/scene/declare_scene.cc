#include <selkie/base/exceptions.h>
#include <selkie/laws/hyperelastic_law.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/scene/parameter_file.h>

#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    using Patterns::Double;
    using Patterns::Integer;

    template <int dim>
    void
    declare_general(ParameterHandler &prm, Scene<dim> &scene)
    {
      prm.add_parameter("Title",
                        scene.title,
                        "One line for the banner and the reports. "
                        "Units: none.");
      prm.declare_entry("Dimension",
                        std::to_string(dim),
                        Integer(2, 3),
                        "Of space; two dimensions are plane strain. "
                        "Units: none.");
      add_choice(prm,
                 "Approximation",
                 scene.approximation,
                 {{"lme mpm", Approximation::lme_mpm},
                  {"q4 mpm", Approximation::q4_mpm},
                  {"q4 fem", Approximation::q4_fem}},
                 "Who carries the unknowns: `lme mpm` is local maximum-entropy "
                 "functions on the nodes of the background mesh, `q4 mpm` hat "
                 "functions on it (the classical material point method), "
                 "`q4 fem` Lagrangian finite elements, whose mesh, fitted to "
                 "the bodies, moves with the matter. Units: none.");
      prm.declare_entry("Effects",
                        "inertia",
                        Patterns::MultipleSelection(listed_effects("|")),
                        "The effects that this scene calls for; a parameter of "
                        "an effect that is not listed is an error. "
                        "Units: none.");
      add_choice(prm,
                 "Points leaving",
                 scene.leaving,
                 {{"stop", LeavingPolicy::stop},
                  {"keep", LeavingPolicy::keep},
                  {"remove", LeavingPolicy::remove}},
                 "What is done with a material point that leaves the domain: "
                 "`stop` the run, `keep` it at the wall, `remove` it; each is "
                 "counted and named in the log. Units: none.");
    }


    /// "a; free": the components of a velocity, some of which may be free.
    template <int dim>
    void
    set_wall_velocity(Wall<dim> &wall, const std::string &text)
    {
      wall.velocity.reset();
      wall.components.fill(false);
      if (text.empty())
        return;
      auto        parts = Utilities::split_string_list(text, ';');
      std::string functions;
      for (unsigned int d = 0; d < parts.size(); ++d)
        {
          const bool is_free = (parts[d] == "free");
          if (d < dim)
            wall.components[d] = !is_free;
          functions += (d > 0 ? "; " : "") + (is_free ? "0" : parts[d]);
        }
      wall.velocity = std::make_shared<VectorExpression<dim>>(functions);
    }


    template <int dim>
    void
    declare_walls(ParameterHandler &prm, Domain<dim> &domain)
    {
      prm.enter_subsection("Walls");
      const auto names = wall_names<dim>();
      for (unsigned int w = 0; w < names.size(); ++w)
        {
          const std::string axis(1, "xyz"[w / 2]);
          add_choice(prm,
                     names[w],
                     domain.walls[w].condition,
                     {{"free", NodeCondition::free},
                      {"fixed", NodeCondition::fixed},
                      {"slip", NodeCondition::slip},
                      {"prescribed", NodeCondition::prescribed}},
                     "What the nodes of the wall at the " +
                       std::string(w % 2 == 0 ? "smallest " : "largest ") +
                       axis +
                       " do: nothing prescribed, all components held, the "
                       "normal one held, or moved with a velocity (effect "
                       "`prescribed motion`). Units: none.");
          prm.declare_entry(names[w] + " velocity",
                            "",
                            Patterns::Anything(),
                            "If `prescribed`: one function of x, y, z, t per "
                            "component, separated by semicolons; `free` for a "
                            "component that is not prescribed. Units: m/s.");
          prm.add_action(names[w] + " velocity",
                         [&wall = domain.walls[w]](const std::string &text) {
                           set_wall_velocity(wall, text);
                         });
        }
      prm.leave_subsection();
    }


    template <int dim>
    void
    declare_refinements(ParameterHandler               &prm,
                        const std::vector<std::string> &names,
                        Domain<dim>                    &domain)
    {
      prm.enter_subsection("Refinements");
      prm.declare_entry("Names",
                        "",
                        Patterns::Anything(),
                        "Names of the regions in which the mesh is finer, "
                        "separated by commas; each is a subsection. "
                        "Units: none.");
      domain.refinements.resize(names.size());
      for (unsigned int i = 0; i < names.size(); ++i)
        {
          domain.refinements[i].name = names[i];
          prm.enter_subsection(names[i]);
          add_shape(prm,
                    "Shape",
                    domain.refinements[i].shape,
                    "Cells that touch it are refined. Units: m.");
          prm.add_parameter("Levels",
                            domain.refinements[i].levels,
                            "How often each of them is halved. Units: none.",
                            Integer(1, 10));
          prm.leave_subsection();
        }
      prm.leave_subsection();
    }


    void
    declare_mesh(ParameterHandler &prm, ImportedMesh &mesh)
    {
      prm.enter_subsection("Mesh");
      prm.add_parameter("File",
                        mesh.file,
                        "A mesh of quadrilaterals or hexahedra to read, in a "
                        "format that deal.II's GridIn knows by its ending "
                        "(.msh of gmsh, .inp, .vtk, .ucd); seen from the "
                        "folder of the scene's file. Units: none.");
      prm.add_parameter("Generator",
                        mesh.generator,
                        "Or the name of one of deal.II's GridGenerator "
                        "functions, such as general_cell. Units: none.");
      prm.add_parameter("Arguments",
                        mesh.arguments,
                        "The generator's arguments, as its manual lists them, "
                        "separated by colons. Units: none.");
      prm.add_parameter("Global refinements",
                        mesh.global_refinements,
                        "How often all its cells are halved. Units: none.",
                        Integer(0, 20));
      prm.leave_subsection();
    }


    template <int dim>
    void
    declare_domain(ParameterHandler &prm,
                   const SceneNames &names,
                   Domain<dim>      &domain)
    {
      for (unsigned int d = 0; d < dim; ++d)
        {
          domain.upper[d] = 1.;
          domain.cells[d] = 16;
        }
      prm.enter_subsection("Domain");
      prm.add_parameter("Lower corner",
                        domain.lower,
                        "Smallest coordinates of the box in which everything "
                        "happens. Units: m.");
      prm.add_parameter("Upper corner",
                        domain.upper,
                        "Largest coordinates of that box. Units: m.");
      prm.add_parameter("Cells",
                        domain.cells,
                        "Cells of the background mesh in each direction, "
                        "before refinement. They must be squares or cubes to "
                        "within 1 %. Units: none.",
                        Patterns::List(Integer(1), dim, dim, ","));
      prm.add_parameter("Balance steps",
                        domain.balance_steps,
                        "On several ranks: so often it is looked at how evenly "
                        "they share the points, and where the fullest has a "
                        "fifth more than the mean the cells are shared out "
                        "anew. 0: never. Units: none.",
                        Integer(0));
      declare_walls(prm, domain);
      declare_refinements(prm, names.refinements, domain);
      if (names.imported_mesh)
        declare_mesh(prm, domain.mesh.emplace());
      prm.leave_subsection();
    }


    /// Makes the effects of the scene; each declares its own parameters.
    template <int dim>
    void
    declare_effects(ParameterHandler &prm,
                    const SceneNames &names,
                    Scene<dim>       &scene)
    {
      for (const EffectRow *row : effects_of(names))
        {
          const auto effect = row->make<dim>();
          if (!row->section.empty())
            prm.enter_subsection(row->section);
          effect->declare(prm, names, scene);
          if (!row->section.empty())
            prm.leave_subsection();
          scene.effects.push_back({row->name, effect});
        }
    }


    void
    declare_output(ParameterHandler &prm, OutputParameters &output)
    {
      prm.enter_subsection("Output");
      prm.add_parameter("Directory",
                        output.directory,
                        "Where everything is written; --output is the same. "
                        "The default is output/ and the name of the .prm. "
                        "Units: none.");
      prm.add_parameter("Interval",
                        output.interval,
                        "Time between two pictures (VTU files); 0 for none. "
                        "Units: s.",
                        Double(0.));
      prm.add_parameter("Mesh",
                        output.mesh,
                        "Whether the pictures include the mesh with the nodal "
                        "fields. Units: none.");
      prm.declare_entry("Audit",
                        "figures",
                        Patterns::Selection("figures|none"),
                        "`figures` is the effect `audit`: energies and their "
                        "balance, momentum, mass, volume and J, summed over "
                        "all points after every step and held against the "
                        "limits in the section `Audit`; `none` is no such pass "
                        "and none of its columns. Units: none.");
      prm.add_parameter("Checkpoint steps",
                        output.checkpoint_steps,
                        "Time steps between two checkpoints, from which "
                        "`selkie resume` goes on; 0 for none by number. "
                        "Units: none.");
      prm.add_parameter("Checkpoint minutes",
                        output.checkpoint_minutes,
                        "Wall time between two checkpoints; 0 for none by "
                        "time. Units: min.",
                        Double(0.));
      prm.leave_subsection();
    }
  } // namespace


  bool
  SceneNames::has_effect(const std::string &name) const
  {
    return std::find(effects.begin(), effects.end(), name) != effects.end();
  }


  namespace
  {
    /// Whether @p is(law) holds for one. Only a law knows what it is, so ask
    /// those made from the defaults.
    template <typename Predicate>
    bool
    any_law(const std::vector<const LawRow *> &laws, const Predicate &is)
    {
      return std::any_of(laws.begin(), laws.end(), [&is](const LawRow *row) {
        ParameterHandler defaults;
        row->declare(defaults);
        return is(*row->create(defaults));
      });
    }

    bool
    has_phase(const std::vector<const LawRow *> &laws, const Phase phase)
    {
      return any_law(laws,
                     [phase](const Law &law) { return law.phase() == phase; });
    }
  } // namespace


  bool
  SceneNames::has_fluid() const
  {
    return has_phase(laws, Phase::fluid);
  }


  bool
  SceneNames::has_solid() const
  {
    return has_phase(laws, Phase::solid);
  }


  bool
  SceneNames::has_coupled_solid() const
  {
    return any_law(laws, [](const Law &law) {
      return law.phase() == Phase::solid &&
             dynamic_cast<const DecoupledLaw *>(&law) == nullptr;
    });
  }


  template <int dim>
  void
  add_walls(ParameterHandler          &prm,
            std::array<bool, 2 * dim> &walls,
            const std::string         &documentation)
  {
    walls.fill(true);
    prm.declare_entry("Walls", "", Patterns::Anything(), documentation);
    prm.add_action("Walls", [&walls](const std::string &text) {
      walls.fill(text.empty());
      for (const auto &item : split_list(text))
        walls[index_of(item, wall_names<dim>(), "wall")] = true;
    });
  }

  template void
  add_walls<2>(ParameterHandler &, std::array<bool, 4> &, const std::string &);
  template void
  add_walls<3>(ParameterHandler &, std::array<bool, 6> &, const std::string &);


  template <int dim>
  std::vector<std::string>
  wall_names()
  {
    static const std::vector<std::string> names = {
      "left", "right", "bottom", "top", "front", "back"};
    return {names.begin(), names.begin() + 2 * dim};
  }


  template <int dim>
  void
  declare_scene(ParameterHandler &prm,
                const SceneNames &names,
                Scene<dim>       &scene)
  {
    declare_general(prm, scene);
    declare_domain(prm, names, scene.domain);
    declare_bodies(prm, names, scene);
    declare_effects(prm, names, scene);
    declare_numerics(prm, scene);
    declare_output(prm, scene.output);
  }


  template std::vector<std::string>
  wall_names<2>();
  template std::vector<std::string>
  wall_names<3>();
  template void
  declare_scene(ParameterHandler &, const SceneNames &, Scene<2> &);
  template void
  declare_scene(ParameterHandler &, const SceneNames &, Scene<3> &);
} // namespace selkie
