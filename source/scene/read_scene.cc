#include <selkie/base/exceptions.h>
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
        , entries(read_entries(file, overrides))
      {}

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
            std::string known;
            bool        found = false;
            for (const auto &row : effect_table())
              {
                known += (known.empty() ? "" : ", ") + row.name;
                found = found || row.name == item;
              }
            if (!found)
              fail("Effects",
                   "there is no effect '" + item +
                     "'; allowed are any of: " + known);
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
        for (const auto &body : result.bodies)
          result.laws.push_back(law_of(body));
        return result;
      }

      const std::string      file;
      const ParameterEntries entries;
    };


    /// The effect that an entry needs, or "".
    std::string
    effect_of(const ParameterEntry &entry)
    {
      const auto       &sections = entry.sections;
      const std::string first    = sections.empty() ? "" : sections[0];
      for (const auto &row : effect_table())
        if (!row.section.empty() && row.section == first)
          return row.name;
      if (first == "Bodies" && sections.back() == "Law parameters" &&
          entry.name == "Viscosity" &&
          entry.value.find_first_not_of("0.") != std::string::npos)
        return "viscosity";
      const bool is_velocity =
        (first == "Node sets" && entry.name == "Velocity") ||
        (sections.size() == 2 && sections[1] == "Walls" &&
         entry.name.find(" velocity") != std::string::npos);
      return is_velocity && !entry.value.empty() ? "prescribed motion" : "";
    }


    /// Parameters of absent effects are refused, with the reason.
    void
    check_effects_of(const SceneReader &reader, const SceneNames &names)
    {
      for (const auto &entry : reader.entries)
        {
          const std::string effect = effect_of(entry);
          if (!effect.empty() && !names.has_effect(effect))
            reader.fail(entry.path(),
                        "it belongs to the effect '" + effect +
                          "', which the scene does not list; add it to "
                          "'Effects' or remove the parameter");
          if (!entry.sections.empty() &&
              entry.sections[0] == "Fluid pressure" && !names.has_fluid())
            reader.fail(entry.path(),
                        "it belongs to fluids, and no body of the scene has a "
                        "fluid's law");
        }
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
          for (unsigned int level = 0; level < 3; ++level)
            prm.leave_subsection();
          body.phase = (body.law->phase() == Phase::fluid ? 0 : ++solids);
        }
    }


    /// What follows from the parameters and is not tied to one of them.
    template <int dim>
    void
    complete(Scene<dim> &scene, const SceneNames &names)
    {
      for (unsigned int w = 0; w < 2 * dim; ++w)
        {
          Wall<dim> &wall = scene.domain.walls[w];
          if (wall.condition != NodeCondition::prescribed)
            wall.components.fill(wall.condition == NodeCondition::fixed);
          if (wall.condition == NodeCondition::slip)
            wall.components[w / 2] = true;
        }
      if (scene.inertia && scene.inertia->mass == MassKind::automatic)
        scene.inertia->mass =
          scene.lagrangian_mesh() ? MassKind::consistent : MassKind::lumped;
      const auto starts_hydrostatic = [](const Body<dim> &body) {
        return body.hydrostatic_start;
      };
      if (names.has_effect("hydrostatic start") &&
          std::none_of(scene.bodies.begin(),
                       scene.bodies.end(),
                       starts_hydrostatic))
        for (auto &body : scene.bodies)
          body.hydrostatic_start = (body.phase == 0);
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
    keep_parameters(prm, reader, scene);
    make_laws(prm, reader, names, scene);
    complete(scene, names);
    if (scene.domain.mesh)
      {
        check_mesh_source(scene);
        std::string &mesh_file = scene.domain.mesh->file;
        if (!mesh_file.empty())
          mesh_file =
            (std::filesystem::path(file).parent_path() / mesh_file).string();
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
