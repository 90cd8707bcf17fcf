#include <selkie/output/files.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace selkie
{
  void
  write_text(const std::string &path, const std::string &text)
  {
    std::ofstream file(path);
    file << text;
    if (!file.flush())
      throw std::runtime_error("cannot write '" + path +
                               "': " + std::strerror(errno));
  }


  std::string
  read_text(const std::string &path)
  {
    std::ifstream      file(path);
    std::ostringstream text;
    if (!file || !(text << file.rdbuf()))
      throw std::runtime_error("cannot read '" + path +
                               "': " + std::strerror(errno));
    return text.str();
  }
} // namespace selkie
