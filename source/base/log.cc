#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/base/log.h>

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <iostream>

namespace selkie
{
  namespace
  {
    /// Terminal code: go to the start of the line and clear it.
    const char *const clear_line = "\r\033[K";
  } // namespace


  Log::Log(const MPI_Comm comm)
    : comm(comm)
    , root(dealii::Utilities::MPI::this_mpi_process(comm) == 0)
    , terminal(root && isatty(STDOUT_FILENO) == 1)
  {}


  Log::~Log()
  {
    if (progress_shown)
      std::cout << std::endl;
  }


  void
  Log::open(const std::string &directory, const bool go_on)
  {
    const std::string name = directory + "/log.txt";
    std::string       error;
    if (root)
      {
        file.open(name, go_on ? std::ios::app : std::ios::out);
        if (!file)
          error = "cannot write '" + name + "': " + std::strerror(errno);
        for (const std::string &text : said)
          file << text << '\n';
        file.flush();
      }
    said.clear();
    throw_on_all_ranks<SceneError>(comm, error);
  }


  void
  Log::line(const std::string &text)
  {
    if (!root)
      return;
    if (progress_shown)
      std::cout << clear_line;
    progress_shown = false;
    std::cout << text << std::endl;
    to_file(text);
  }


  void
  Log::progress(const std::string &text)
  {
    if (!root)
      return;
    if (terminal)
      std::cout << clear_line << text << std::flush;
    else
      std::cout << text << std::endl;
    progress_shown = terminal;
    to_file(text);
  }


  bool
  Log::on_terminal() const
  {
    return terminal;
  }


  void
  Log::to_file(const std::string &text)
  {
    if (file.is_open())
      file << text << std::endl;
    else
      said.push_back(text);
  }
} // namespace selkie
