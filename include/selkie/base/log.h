#pragma once

#include <deal.II/base/mpi.h>

#include <fstream>
#include <string>
#include <vector>

namespace selkie
{
  /**
   * What the program says: on the screen and, once there is an output folder,
   * in its log.txt. Rank 0 speaks, the other ranks are silent.
   */
  class Log
  {
  public:
    explicit Log(const MPI_Comm comm);

    /// Ends an unfinished progress line.
    ~Log();

    Log(const Log &) = delete;
    Log &
    operator=(const Log &) = delete;

    /// From here on also to `directory`/log.txt, which starts (or goes on) with
    /// what was said before. Collective.
    /// @throw SceneError, on all ranks, if the file cannot be written.
    void
    open(const std::string &directory, const bool go_on = false);

    /// Says one line (or several, separated by newlines).
    void
    line(const std::string &text = "");

    /// Says how far the run is: on a terminal, a line that the next one
    /// overwrites; otherwise, and in log.txt, a line like any other.
    void
    progress(const std::string &text);

    /// Whether rank 0's standard output is a terminal; false on other ranks.
    bool
    on_terminal() const;

  private:
    void
    to_file(const std::string &text);

    const MPI_Comm           comm;
    const bool               root;
    const bool               terminal;
    bool                     progress_shown = false;
    std::vector<std::string> said; ///< before open()
    std::ofstream            file;
  };
} // namespace selkie
