#include <selkie/base/text.h>

namespace selkie
{
  std::string
  join(const std::vector<std::string> &words)
  {
    std::string text;
    for (const auto &word : words)
      text += (text.empty() ? "" : ", ") + word;
    return text.empty() ? "none" : text;
  }


  std::string
  time_span(const double seconds)
  {
    return seconds < 1.      ? format("%.2g s", seconds)
           : seconds < 10.   ? format("%.1f s", seconds)
           : seconds < 300.  ? format("%.0f s", seconds)
           : seconds < 7200. ? format("%.0f min", seconds / 60.)
                             : format("%.1f h", seconds / 3600.);
  }
} // namespace selkie
