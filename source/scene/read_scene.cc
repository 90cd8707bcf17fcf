#include <selkie/base/exceptions.h>
#include <selkie/laws/hyperelastic_law.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/imported_mesh.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/scene/read_scene.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Entries of one scene, with messages that name the file.
    class SceneReader
    {
    public:
      SceneReader(const std::string              &file,
                  const std::vector<std::string> &overrides)
        : file(file)
        , entries(of_scene(read_entries(file, overrides)))
      {}

      /// Without the subsection of a study, which is none of the scene's.
      static ParameterEntries
      of_scene(ParameterEntries entries)
      {
        entries.erase(std::remove_if(entries.begin(),
                                     entries.end(),
                                     [](const ParameterEntry &entry) {
                                       return !entry.sections.empty() &&
                                              entry.sections[0] == "Study";
                                     }),
                      entries.end());
        return entries;
      }

      [[noreturn]] void
      fail(const std::string &path, const std::string &why) const
      {
        const ParameterEntry *entry = find_entry(entries, path);
        throw SceneError(parameter_message(
          entry ? entry->origin : file, path, entry ? entry->value : "", why));
      }

      /// A list of names that are to be subsections.
      std::vector<std::string>
      names(const std::string &path) const
      {
        const auto list = split_list(value_of(entries, path));
        for (unsigned int i = 0; i < list.size(); ++i)
          {
            if (list[i].find_first_of("/=\\") != std::string::npos ||
                list[i] == "Names" || list[i] == "Interval")
              fail(path,
                   "'" + list[i] +
                     "' cannot be a name; allowed are words "
                     "without / = and \\");
            if (std::count(list.begin(), list.end(), list[i]) > 1)
              fail(path, "the name '" + list[i] + "' is listed twice");
          }
        return list;
      }

      std::vector<std::string>
      effects() const
      {
        auto list = split_list(value_of(entries, "Effects", "inertia"));
        for (const auto &item : list)
          {
            const EffectRow *row = find_effect(item);
            if (row == nullptr)
              fail("Effects",
                   "there is no effect '" + item +
                     "'; allowed are any of: " + listed_effects(", "));
            if (row->comes_with != nullptr)
              fail("Effects",
                   "'" + item +
                     "' comes by itself with what needs it and is not listed");
            if (std::count(list.begin(), list.end(), item) > 1)
              fail("Effects", "'" + item + "' is listed twice");
          }
        return list;
      }

      /// Whether the scene sets a parameter of this subsection.
      bool
      has_section(const std::vector<std::string> &sections) const
      {
        return std::any_of(entries.begin(),
                           entries.end(),
                           [&](const ParameterEntry &entry) {
                             return entry.sections == sections;
                           });
      }

      const LawRow *
      law_of(const std::string &body) const
      {
        const std::string path = "Bodies/" + body + "/Law";
        const LawRow     *row  = find_law(value_of(entries, path));
        if (row == nullptr)
          fail(path,
               "the body needs a law; allowed is one of: " +
                 Patterns::Selection(law_names())
                   .description(Patterns::PatternBase::Text));
        return row;
      }

      SceneNames
      scene_names() const
      {
        SceneNames result;
        result.effects       = effects();
        result.bodies        = names("Bodies/Names");
        result.refinements   = names("Domain/Refinements/Names");
        result.node_sets     = names("Node sets/Names");
        result.tractions     = names("Tractions/Names");
        result.probes        = names("Probes/Names");
        result.imported_mesh = has_section({"Domain", "Mesh"});
        const auto walls     = value_of(entries, "Dimension", "2") == "3"
                                 ? wall_names<3>()
                                 : wall_names<2>();
        result.holding_walls =
          std::any_of(walls.begin(), walls.end(), [this](const auto &wall) {
            return value_of(entries, "Domain/Walls/" + wall, "slip") != "free";
          });
        result.audit = value_of(entries, "Output/Audit", "figures") != "none";
        for (const auto &body : result.bodies)
          result.laws.push_back(law_of(body));
        return result;
      }

      const std::string      file;
      const ParameterEntries entries;
    };


    /// Whether an entry has no meaning without an effect.
    bool
    belongs_to(const ParameterEntry &entry, const EffectRow &row)
    {
      if (entry.value.empty()) // an empty list of names
        return false;
      return (!row.section.empty() && !entry.sections.empty() &&
              entry.sections[0] == row.section) ||
             (row.claims != nullptr && row.claims(entry));
    }


    /// Parameters of absent effects are refused, with the reason.
    void
    check_effects_of(const SceneReader &reader, const SceneNames &names)
    {
      const auto active = effects_of(names);
      for (const auto &row : effect_table())
        if (std::find(active.begin(), active.end(), &row) == active.end())
          for (const auto &entry : reader.entries)
            if (belongs_to(entry, row))
              reader.fail(entry.path(),
                          row.comes_with == nullptr
                            ? "it belongs to the effect '" + row.name +
                                "', which the scene does not list; add it to "
                                "'Effects' or remove the parameter"
                            : "it belongs to the effect '" + row.name +
                                "', and nothing in the scene calls for it");
      for (unsigned int b = 0; b < names.laws.size(); ++b)
        if (!names.laws[b]->needs_effect.empty() &&
            !names.has_effect(names.laws[b]->needs_effect))
          reader.fail("Bodies/" + names.bodies[b] + "/Law",
                      "this law needs the effect '" +
                        names.laws[b]->needs_effect +
                        "', which the scene does not list");
    }


    template <int dim>
    void
    make_laws(ParameterHandler  &prm,
              const SceneReader &reader,
              const SceneNames  &names,
              Scene<dim>        &scene)
    {
      unsigned int solids = 0;
      for (unsigned int i = 0; i < scene.bodies.size(); ++i)
        {
          auto &body = scene.bodies[i];
          prm.enter_subsection("Bodies");
          prm.enter_subsection(body.name);
          prm.enter_subsection("Law parameters");
          try
            {
              body.law = names.laws[i]->create(prm);
            }
          catch (const SceneError &error)
            {
              throw SceneError(reader.file + ": Bodies/" + body.name +
                               "/Law parameters: " + error.what());
            }
          catch (const dealii::ExceptionBase &) // of get_double()
            {
              throw SceneError(reader.file + ": Bodies/" + body.name +
                               "/Law parameters: a number is too small for "
                               "double precision; allowed are 0 and numbers "
                               "beyond 2.3e-308");
            }
          for (unsigned int level = 0; level < 3; ++level)
            prm.leave_subsection();
          const bool fluid = body.law->phase() == Phase::fluid;
          body.phase       = fluid ? 0 : ++solids;
          body.has_pressure =
            fluid || (scene.mixed_solids &&
                      dynamic_cast<const DecoupledLaw *>(body.law.get()));
        }
    }


    /// Layers of nodes: the first is that of all bodies that are not named, the
    /// others belong to one body each.
    template <int dim>
    void
    give_layers(Scene<dim> &scene)
    {
      std::vector<bool> alone(scene.bodies.size(), false);
      for (unsigned int i = 0; i < scene.bodies.size(); ++i)
        alone[i] = scene.contact->empty() &&
                   scene.bodies[i].law->phase() == Phase::solid;
      for (const unsigned int body : *scene.contact)
        alone[body] = true;
      unsigned int next =
        std::find(alone.begin(), alone.end(), false) == alone.end() ? 0 : 1;
      for (unsigned int i = 0; i < scene.bodies.size(); ++i)
        scene.bodies[i].layer = alone[i] ? next++ : 0;
    }


    /// What follows from the parameters and is not tied to one of them.
    template <int dim>
    void
    complete(Scene<dim> &scene)
    {
      for (unsigned int w = 0; w < 2 * dim; ++w)
        {
          Wall<dim> &wall = scene.domain.walls[w];
          if (wall.condition != NodeCondition::prescribed)
            wall.components.fill(wall.condition == NodeCondition::fixed);
          if (wall.condition == NodeCondition::slip)
            wall.components[w / 2] = true;
        }
      if (scene.contact)
        give_layers(scene);
      if (scene.inertia && scene.inertia->mass == MassKind::automatic)
        scene.inertia->mass =
          scene.lagrangian_mesh() ? MassKind::consistent : MassKind::lumped;
    }


    template <int dim>
    void
    keep_parameters(const ParameterHandler &prm,
                    const SceneReader      &reader,
                    Scene<dim>             &scene)
    {
      for (const auto &parameter : declared_parameters(prm))
        {
          const auto *entry = find_entry(reader.entries, parameter.path);
          scene.parameters[parameter.path] = {parameter.value,
                                              entry ? entry->origin : ""};
        }
      std::ostringstream text;
      text << "# Every parameter of " << reader.file << ", defaults included\n";
      prm.print_parameters(text,
                           ParameterHandler::ShortPRM |
                             ParameterHandler::KeepDeclarationOrder);
      scene.resolved = text.str();
    }
  } // namespace


  unsigned int
  read_dimension(const std::string              &file,
                 const std::vector<std::string> &overrides)
  {
    const SceneReader reader(file, overrides);
    const std::string value = value_of(reader.entries, "Dimension", "2");
    if (value != "2" && value != "3")
      reader.fail("Dimension", "allowed is 2 or 3");
    return value == "2" ? 2 : 3;
  }


  template <int dim>
  Scene<dim>
  read_scene(const std::string &file, const std::vector<std::string> &overrides)
  {
    const SceneReader reader(file, overrides);
    const SceneNames  names = reader.scene_names();
    check_effects_of(reader, names);

    Scene<dim> scene;
    scene.file = file;
    scene.output.directory =
      "output/" + std::filesystem::path(file).stem().string();
    ParameterHandler prm;
    declare_scene(prm, names, scene);
    apply_entries(prm, reader.entries);
    AssertThrow(prm.get_integer("Dimension") == dim, ExcInternalError());
    if (scene.domain.mesh && !scene.domain.mesh->file.empty())
      {
        // Its place does not depend on where parameters.prm is read from.
        prm.enter_subsection("Domain");
        prm.enter_subsection("Mesh");
        prm.set("File",
                std::filesystem::absolute(
                  std::filesystem::path(file).parent_path() /
                  scene.domain.mesh->file)
                  .string());
        prm.leave_subsection();
        prm.leave_subsection();
      }
    keep_parameters(prm, reader, scene);
    make_laws(prm, reader, names, scene);
    complete(scene);
    if (scene.domain.mesh)
      {
        check_mesh_source(scene);
        fit_box(scene.domain);
      }
    check_scene(scene);
    return scene;
  }


  template Scene<2>
  read_scene(const std::string &, const std::vector<std::string> &);
  template Scene<3>
  read_scene(const std::string &, const std::vector<std::string> &);
} // namespace selkie
