#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/output/output_folder.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

namespace selkie
{
  namespace
  {
    namespace fs = std::filesystem;

    void
    write_text(const fs::path &path, const std::string &text)
    {
      std::ofstream file(path);
      file << text;
      if (!file.flush())
        throw SceneError("'" + path.string() + "': " + std::strerror(errno));
    }

    std::string
    read_text(const fs::path &path)
    {
      std::ifstream      file(path);
      std::ostringstream text;
      text << file.rdbuf();
      return text.str();
    }

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
      write_text(folder / "original.prm", original);
      remove_earlier_run(folder);
      write_text(folder / "parameters.prm", parameters);
    }
  } // namespace


  void
  create_output_folder(const std::string &directory,
                       const std::string &scene_file,
                       const std::string &parameters,
                       const MPI_Comm     comm)
  {
    std::string reason;
    if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
      try
        {
          // Read first: the scene's file may be the original.prm there.
          prepare(directory, read_text(scene_file), parameters);
        }
      catch (const std::runtime_error &error)
        {
          reason = error.what();
        }
    throw_on_all_ranks<SceneError>(
      comm,
      reason.empty()
        ? ""
        : "the output folder '" + directory + "' cannot be written (" + reason +
            "); choose one that can be, with --output or in the scene");
  }
} // namespace selkie
