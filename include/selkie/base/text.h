#pragma once

#include <cstdio>
#include <string>
#include <vector>

/**
 * @file
 * Text for people: in the log and on the screen.
 */
namespace selkie
{
  /// printf to a string (at most 511 characters).
  template <typename... Values>
  std::string
  format(const char *pattern, const Values... values)
  {
    char text[512];
    std::snprintf(text, sizeof(text), pattern, values...);
    return text;
  }

  /// Words separated by commas, or "none".
  std::string
  join(const std::vector<std::string> &words);

  /// A time span in the unit that suits it.
  std::string
  time_span(const double seconds);
} // namespace selkie
