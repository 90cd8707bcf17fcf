// Boost 1.74's property tree notes its own use of bind otherwise.
#define BOOST_BIND_GLOBAL_PLACEHOLDERS
#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/forest.h>
#include <selkie/output/checkpoint.h>
#include <selkie/output/files.h>
#include <selkie/output/json.h>

#include <deal.II/distributed/cell_data_transfer.h>
#include <deal.II/distributed/solution_transfer.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/lac/vector.h>

#include <boost/archive/text_iarchive.hpp>
#include <boost/archive/text_oarchive.hpp>
#include <boost/property_tree/json_parser.hpp>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

namespace selkie
{
  namespace
  {
    namespace fs = std::filesystem;

    /// Writes something on rank 0; its failure is thrown on all ranks.
    template <typename Action>
    void
    on_root(const MPI_Comm comm, const Action &action)
    {
      fail_together<OutputError>(comm, [&] {
        if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
          action();
      });
    }

    /// e.g. "000120"
    std::string
    folder_name(const unsigned int step)
    {
      const std::string number = std::to_string(step);
      return std::string(6 - std::min<std::size_t>(6, number.size()), '0') +
             number;
    }

    /// The step that a folder_name() says; nothing of another name.
    std::optional<unsigned int>
    step_of(const std::string &name)
    {
      unsigned int step    = 0;
      const char  *end     = name.data() + name.size();
      const auto [at, bad] = std::from_chars(name.data(), end, step);
      if (bad != std::errc() || at != end)
        return {};
      return step;
    }

    /// The folders of checkpoints by their steps, the latest first.
    std::map<unsigned int, fs::path, std::greater<>>
    folders_by_step(const fs::path &checkpoints)
    {
      std::map<unsigned int, fs::path, std::greater<>> folders;
      for (const auto &entry : fs::directory_iterator(checkpoints))
        if (const auto step = step_of(entry.path().filename().string());
            step && entry.is_directory())
          folders[*step] = entry.path();
      return folders;
    }

    /// The columns that a point carries, as one text to compare.
    std::string
    columns_text(const ParticleFields &fields)
    {
      std::string text;
      for (const ParticleFields::Entry &entry : fields.entries())
        text += (text.empty() ? "" : ", ") + entry.name + " x " +
                std::to_string(entry.n_components);
      return text;
    }

    template <typename Value>
    std::string
    names_text(const std::map<std::string, Value> &fields)
    {
      std::string text;
      for (const auto &[name, values] : fields)
        text += (text.empty() ? "" : ", ") + name;
      return text;
    }

    /// Carries fields on the nodes with the cells of the mesh.
    template <int dim>
    using FieldTransfer =
      dealii::parallel::distributed::SolutionTransfer<dim, Vector>;

    /// Values of the cells, carried with them.
    template <int dim>
    using CellTransfer = dealii::parallel::distributed::
      CellDataTransfer<dim, dim, dealii::Vector<double>>;

    /// The first of this rank's cells in p4est's order.
    template <int dim>
    typename dealii::Triangulation<dim>::active_cell_iterator
    first_own_cell(
      const dealii::parallel::distributed::Triangulation<dim> &mesh)
    {
      const auto place = [&mesh](const auto &cell) {
        return std::pair(tree_of<dim>(mesh, cell), cell->id());
      };
      auto first = mesh.end();
      for (const auto &cell : mesh.active_cell_iterators())
        if (cell->is_locally_owned() &&
            (first == mesh.end() || place(cell) < place(first)))
          first = cell;
      return first;
    }

    /// Weights of the cells, whole numbers, by which p4est shares them out as
    /// they are: those of each rank have the same sum, and where that sum is
    /// reached inside a cell, p4est gives the cell to the next rank. So a first
    /// cell that weighs as much as the ranks before it leaves them without any.
    template <int dim>
    dealii::Vector<double>
    weights_of_partition(
      const dealii::parallel::distributed::Triangulation<dim> &mesh)
    {
      const auto n =
        dealii::Utilities::MPI::all_gather(mesh.get_communicator(),
                                           mesh.n_locally_owned_active_cells());
      const unsigned int     sum = *std::max_element(n.begin(), n.end());
      unsigned int           me  = mesh.locally_owned_subdomain();
      dealii::Vector<double> weights(mesh.n_active_cells());
      if (n[me] == 0)
        return weights;
      for (const auto &cell : mesh.active_cell_iterators())
        if (cell->is_locally_owned())
          weights[cell->active_cell_index()] = sum / n[me];
      double &first = weights[first_own_cell(mesh)->active_cell_index()];
      first += sum % n[me];
      for (; me > 0 && n[me - 1] == 0; --me)
        first += sum;
      return weights;
    }

    JsonObject
    to_json(const CheckpointState &state)
    {
      JsonObject json;
      json.add("time", state.time);
      json.add("step", state.step);
      json.add("dt", state.dt);
      json.add("seeded", state.accounting.seeded);
      json.add("removed", state.accounting.removed);
      json.add("kept at wall", state.accounting.kept_at_wall);
      json.add("split", state.accounting.split);
      json.add("merged", state.accounting.merged);
      json.add("seeded mass", state.accounting.seeded_mass);
      json.add("removed mass", state.accounting.removed_mass);
      return json;
    }

    CheckpointState
    from_json(const boost::property_tree::ptree &json)
    {
      CheckpointState state;
      state.time               = json.get<double>("time");
      state.step               = json.get<unsigned int>("step");
      state.dt                 = json.get<double>("dt");
      state.accounting.seeded  = json.get<unsigned long long>("seeded");
      state.accounting.removed = json.get<unsigned long long>("removed");
      state.accounting.kept_at_wall =
        json.get<unsigned long long>("kept at wall");
      state.accounting.split        = json.get<unsigned long long>("split", 0);
      state.accounting.merged       = json.get<unsigned long long>("merged", 0);
      state.accounting.seeded_mass  = json.get<double>("seeded mass");
      state.accounting.removed_mass = json.get<double>("removed mass");
      return state;
    }

    /// Names the new checkpoint and removes all but it and the previous one.
    void
    mark_good(const fs::path &checkpoints, const std::string &name)
    {
      const fs::path    mark = checkpoints / "last_good";
      const std::string previous =
        fs::exists(mark) ? read_text(mark.string()) : "";
      write_text((checkpoints / "last_good.new").string(), name);
      fs::rename(checkpoints / "last_good.new", mark);

      for (const auto &[step, folder] : folders_by_step(checkpoints))
        if (folder.filename() != name && folder.filename() != previous)
          fs::remove_all(folder);
    }

    /// The files of a checkpoint but checkpoint.json, with their sizes.
    JsonObject
    sizes(const fs::path &folder)
    {
      JsonObject json;
      for (const auto &entry : fs::directory_iterator(folder))
        if (const auto name = entry.path().filename().string();
            name != "checkpoint.json")
          json.add(name, static_cast<unsigned long long>(entry.file_size()));
      return json;
    }

    /// What is wrong with a checkpoint, or "".
    std::string
    damage(const fs::path &folder)
    {
      boost::property_tree::ptree json;
      try
        {
          boost::property_tree::read_json((folder / "checkpoint.json").string(),
                                          json);
          for (const auto &[name, size] : json.get_child("files"))
            {
              const fs::path file = folder / name;
              if (!fs::exists(file))
                return "'" + file.string() + "' is missing";
              if (fs::file_size(file) != size.get_value<unsigned long long>())
                return "'" + file.string() + "' has " +
                       std::to_string(fs::file_size(file)) +
                       " bytes, written were " + size.data();
            }
        }
      catch (const std::exception &error)
        {
          return error.what();
        }
      return "";
    }

    template <int dim>
    JsonObject
    description(const Scene<dim>                            &scene,
                const ParticleSet<dim>                      &particles,
                const std::map<std::string, const Vector *> &nodal_fields,
                const CheckpointState                       &state,
                const fs::path                              &folder)
    {
      JsonObject json;
      json.add("scene", scene.file);
      json.add("dim", dim);
      json.add("ranks",
               dealii::Utilities::MPI::n_mpi_processes(
                 particles.communicator()));
      json.add("points", particles.handler().n_global_particles());
      json.add("columns", columns_text(particles.fields));
      json.add("nodal fields", names_text(nodal_fields));
      json.add("state", to_json(state));
      json.add("files", sizes(folder));
      return json;
    }

    /// Reads checkpoint.json and compares it with the scene that resumes.
    boost::property_tree::ptree
    read_description(const fs::path       &folder,
                     const ParticleFields &fields,
                     const unsigned int    dim)
    {
      boost::property_tree::ptree json;
      boost::property_tree::read_json((folder / "checkpoint.json").string(),
                                      json);
      const std::string columns = columns_text(fields);
      if (json.get<unsigned int>("dim") != dim ||
          json.get<std::string>("columns") != columns)
        throw SceneError(
          "'" + folder.string() + "' is of a " + json.get<std::string>("dim") +
          "D scene whose points carry " + json.get<std::string>("columns") +
          "; this scene has " + std::to_string(dim) + "D points that carry " +
          columns);
      return json;
    }
  } // namespace


  template <int dim>
  std::string
  write_checkpoint(const std::string                                 &directory,
                   const Scene<dim>                                  &scene,
                   ParticleSet<dim>                                  &particles,
                   dealii::parallel::distributed::Triangulation<dim> &mesh,
                   const dealii::DoFHandler<dim>                     &dofs,
                   const std::map<std::string, const Vector *> &nodal_fields,
                   const double                                 time,
                   const unsigned int                           step,
                   const double                                 dt,
                   const std::string                           &run)
  {
    const MPI_Comm        comm        = particles.communicator();
    const fs::path        checkpoints = fs::path(directory) / "checkpoint";
    const std::string     name        = folder_name(step);
    const fs::path        folder      = checkpoints / name;
    const CheckpointState state{time, step, dt, particles.accounting, run};

    on_root(comm, [&]() {
      fs::remove_all(folder);
      fs::create_directories(folder);
    });

    particles.handler().prepare_for_serialization();
    FieldTransfer<dim>            transfer(dofs);
    std::map<std::string, Vector> fields;
    std::vector<const Vector *>   values;
    for (const auto &[name, field] : nodal_fields)
      {
        fields[name] = *field;
        CarriedFields<dim>::make_portable(fields[name]);
        values.push_back(&fields[name]);
      }
    if (!values.empty())
      transfer.prepare_for_serialization(values);
    const auto        weights = weights_of_partition(mesh);
    CellTransfer<dim> partition(mesh);
    partition.prepare_for_serialization(weights);
    mesh.save((folder / "mesh").string());

    on_root(comm, [&]() {
      std::ostringstream            counters;
      boost::archive::text_oarchive archive(counters);
      archive << std::as_const(particles).handler();
      write_text((folder / "points").string(), counters.str());
      write_text((folder / "run").string(), run);
      description(scene, particles, nodal_fields, state, folder)
        .write((folder / "checkpoint.json").string());
      mark_good(checkpoints, name);
    });
    return folder.string();
  }


  FoundCheckpoint
  find_checkpoint(const std::string &directory)
  {
    const fs::path checkpoints = fs::path(directory) / "checkpoint";
    if (!fs::exists(checkpoints / "last_good"))
      throw SceneError("there is no checkpoint in '" + directory +
                       "'; a run writes them every 'Output/Checkpoint steps' "
                       "or 'Output/Checkpoint minutes', and when it fails");
    const std::string mark = read_text((checkpoints / "last_good").string());
    const auto        last = step_of(mark);
    if (!last)
      throw SceneError("'" + (checkpoints / "last_good").string() + "' says '" +
                       mark +
                       "'; it should name the folder of a checkpoint there");
    const auto      folders = folders_by_step(checkpoints);
    FoundCheckpoint result;
    for (auto it = folders.lower_bound(*last); it != folders.end(); ++it)
      {
        const std::string wrong = damage(it->second);
        if (wrong.empty())
          {
            result.folder = it->second.string();
            return result;
          }
        result.damage += (result.damage.empty() ? "" : "; ") + wrong;
      }
    throw SceneError("no checkpoint in '" + directory +
                     "' can be used: " + result.damage);
  }


  template <int dim>
  CheckpointState
  read_checkpoint(const std::string                                 &folder,
                  ParticleSet<dim>                                  &particles,
                  dealii::parallel::distributed::Triangulation<dim> &mesh,
                  CarriedFields<dim> &nodal_fields)
  {
    const MPI_Comm              comm = particles.communicator();
    boost::property_tree::ptree json;
    std::string                 points, run;
    fail_together<SceneError>(comm, [&] {
      json   = read_description(folder, particles.fields, dim);
      points = read_text(folder + "/points");
      run    = read_text(folder + "/run");
    });

    nodal_fields.dofs.clear();
    particles.handler().clear();
    reset_to_coarse_cells(particles.scene.domain, mesh);
    mesh.load(folder + "/mesh");
    std::istringstream            counters(points);
    boost::archive::text_iarchive archive(counters);
    archive >> particles.handler();
    particles.handler().deserialize();

    nodal_fields.dofs.reinit(mesh);
    nodal_fields.n_layers = particles.scene.n_layers();
    nodal_fields.values.clear();
    for (const auto &name : dealii::Utilities::split_string_list(
           json.get<std::string>("nodal fields")))
      nodal_fields.values[name];
    nodal_fields.reinit();
    auto values = nodal_fields.pointers();
    if (!values.empty())
      {
        FieldTransfer<dim> transfer(nodal_fields.dofs);
        transfer.deserialize(values);
        for (Vector *field : values)
          CarriedFields<dim>::unmake_portable(*field);
        nodal_fields.update_ghosts();
      }

    CellTransfer<dim>      partition(mesh);
    dealii::Vector<double> weights(mesh.n_active_cells());
    partition.deserialize(weights);

    CheckpointState state = from_json(json.get_child("state"));
    state.run             = run;
    particles.accounting  = state.accounting;
    // deal.II shares the cells out evenly, whoever had them before.
    const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(comm);
    if (n_ranks > 1)
      nodal_fields.carry_along([&] {
        if (n_ranks == json.get<unsigned int>("ranks"))
          particles.rebalance([&weights](const auto &cell) {
            return static_cast<unsigned int>(
              weights[cell->active_cell_index()]);
          });
        else
          particles.rebalance();
      });
    return state;
  }


#define INSTANTIATE(dim)                                 \
  template std::string write_checkpoint(                 \
    const std::string &,                                 \
    const Scene<dim> &,                                  \
    ParticleSet<dim> &,                                  \
    dealii::parallel::distributed::Triangulation<dim> &, \
    const dealii::DoFHandler<dim> &,                     \
    const std::map<std::string, const Vector *> &,       \
    const double,                                        \
    const unsigned int,                                  \
    const double,                                        \
    const std::string &);                                \
  template CheckpointState read_checkpoint(              \
    const std::string &,                                 \
    ParticleSet<dim> &,                                  \
    dealii::parallel::distributed::Triangulation<dim> &, \
    CarriedFields<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
