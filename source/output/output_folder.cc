#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/output/files.h>
#include <selkie/output/output_folder.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

namespace selkie
{
  namespace
  {
    namespace fs = std::filesystem;

    /// Removes the files in a folder that begin and end so, if it exists.
    void
    remove_files(const fs::path    &folder,
                 const std::string &begin,
                 const std::string &end)
    {
      if (!fs::is_directory(folder))
        return;
      std::vector<fs::path> found;
      for (const auto &entry : fs::directory_iterator(folder))
        {
          const std::string name = entry.path().filename().string();
          if (entry.is_regular_file() &&
              name.size() >= begin.size() + end.size() &&
              name.compare(0, begin.size(), begin) == 0 &&
              name.compare(name.size() - end.size(), end.size(), end) == 0)
            found.push_back(entry.path());
        }
      for (const fs::path &path : found)
        fs::remove(path);
    }

    /// What an earlier run left and this one might not overwrite. A folder
    /// without parameters.prm is not of our making.
    void
    remove_earlier_run(const fs::path &folder)
    {
      if (!fs::exists(folder / "parameters.prm"))
        return;
      for (const char *end : {".vtu", ".pvtu"})
        {
          remove_files(folder / "solution", "particles_", end);
          remove_files(folder / "solution", "mesh_", end);
        }
      remove_files(folder / "probes", "", ".csv");
      for (const char *name : {"particles.pvd",
                               "mesh.pvd",
                               "statistics.csv",
                               "timing.csv",
                               "summary.json",
                               "log.txt"})
        fs::remove(folder / name);
      // A checkpoint of another run must not be resumed by mistake.
      if (fs::exists(folder / "checkpoint" / "last_good"))
        fs::remove_all(folder / "checkpoint");
    }

    void
    prepare(const fs::path    &folder,
            const std::string &original,
            const std::string &parameters)
    {
      fs::create_directories(folder / "solution");
      fs::create_directories(folder / "probes");
      write_text((folder / "original.prm").string(), original);
      remove_earlier_run(folder);
      write_text((folder / "parameters.prm").string(), parameters);
    }

    /// Runs on rank 0; what it throws is a SceneError on all ranks.
    template <typename Action>
    void
    on_root(const std::string &directory,
            const MPI_Comm     comm,
            const Action      &action)
    {
      std::string reason;
      if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
        try
          {
            action();
          }
        catch (const std::runtime_error &error)
          {
            reason = error.what();
          }
      throw_on_all_ranks<SceneError>(
        comm,
        reason.empty()
          ? ""
          : "the output folder '" + directory + "' cannot be written (" +
              reason +
              "); choose one that can be, with --output or in the scene");
    }

    /// Removes the rows of a table whose "time (s)" is later than t. Written
    /// aside and renamed: nothing is lost on a full disk.
    void
    cut_table(const fs::path &path, const double t)
    {
      std::istringstream table(read_text(path.string()));
      std::string        line, kept;
      std::getline(table, line);
      const std::string  header = line;
      std::istringstream names(header);
      unsigned int       column = 0;
      for (std::string name;
           std::getline(names, name, ',') && name != "time (s)";)
        ++column;
      kept = header + '\n';
      while (std::getline(table, line))
        {
          std::istringstream cells(line);
          std::string        cell;
          for (unsigned int i = 0; i <= column; ++i)
            std::getline(cells, cell, ',');
          // The last row of a run that was killed may be a part of one.
          const bool whole = std::count(line.begin(), line.end(), ',') ==
                             std::count(header.begin(), header.end(), ',');
          if (whole && std::strtod(cell.c_str(), nullptr) <= t)
            kept += line + '\n';
        }
      write_text(path.string() + ".new", kept);
      fs::rename(path.string() + ".new", path);
    }
  } // namespace


  void
  create_output_folder(const std::string &directory,
                       const std::string &scene_file,
                       const std::string &parameters,
                       const MPI_Comm     comm)
  {
    on_root(directory, comm, [&] {
      // Read first: the scene's file may be the original.prm there.
      prepare(directory, read_text(scene_file), parameters);
    });
  }


  void
  continue_output_folder(const std::string &directory,
                         const std::string &parameters,
                         const MPI_Comm     comm)
  {
    on_root(directory, comm, [&] {
      write_text(directory + "/parameters.prm", parameters);
    });
  }


  void
  cut_tables(const std::string &directory, const double t, const MPI_Comm comm)
  {
    fail_together<OutputError>(comm, [&] {
      if (dealii::Utilities::MPI::this_mpi_process(comm) != 0)
        return;
      const fs::path statistics = fs::path(directory) / "statistics.csv";
      if (fs::exists(statistics))
        cut_table(statistics, t);
      std::vector<fs::path> probes;
      for (const auto &entry :
           fs::directory_iterator(fs::path(directory) / "probes"))
        if (entry.path().extension() == ".csv")
          probes.push_back(entry.path());
      for (const fs::path &path : probes)
        cut_table(path, t);
    });
  }
} // namespace selkie
