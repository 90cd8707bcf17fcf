#include <selkie/output/files.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace selkie
{
  void
  write_file(const std::string                         &path,
             const std::function<void(std::ostream &)> &write)
  {
    std::ofstream file(path);
    if (file)
      try
        {
          write(file);
        }
      catch (...)
        {
          // A stream that fails is reported below, with path and reason.
          if (file)
            throw;
        }
    if (!file.flush())
      throw std::runtime_error("cannot write '" + path +
                               "': " + std::strerror(errno));
  }


  void
  write_text(const std::string &path, const std::string &text)
  {
    write_file(path, [&](std::ostream &file) { file << text; });
  }


  std::string
  read_text(const std::string &path)
  {
    std::ifstream      file(path);
    std::ostringstream text;
    // An empty file is none that cannot be read.
    if (!file || (file.peek() != EOF && !(text << file.rdbuf())))
      throw std::runtime_error("cannot read '" + path +
                               "': " + std::strerror(errno));
    return text.str();
  }
} // namespace selkie
