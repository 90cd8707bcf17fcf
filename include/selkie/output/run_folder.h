#pragma once

#include <string>
#include <vector>

namespace selkie
{
  /// What the output folder of a run says about it.
  struct RunFolder
  {
    std::string              path;
    std::string              name; ///< last part of the path
    unsigned int             dimension = 2;
    std::string              approximation; ///< e.g. "lme mpm"
    std::vector<std::string> bodies; ///< by the column "body" of the points

    /// Empty: done; else what summary.json says instead, or that there is
    /// none.
    std::string unfinished;
  };

  /// @throw SceneError if the folder was not written by a run of Selkie.
  RunFolder
  read_run_folder(const std::string &path);
} // namespace selkie
