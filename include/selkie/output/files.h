#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace selkie
{
  /// Writes a whole file through a stream.
  /// @throw std::runtime_error with path and reason if it cannot be written.
  void
  write_file(const std::string                         &path,
             const std::function<void(std::ostream &)> &write);

  /// Writes a whole file.
  /// @throw std::runtime_error with path and reason if it cannot be written.
  void
  write_text(const std::string &path, const std::string &text);

  /// A whole file.
  /// @throw std::runtime_error with path and reason if it cannot be read.
  std::string
  read_text(const std::string &path);
} // namespace selkie
