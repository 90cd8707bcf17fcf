#pragma once

#include <selkie/study/study.h>

#include <string>

namespace selkie
{
  /**
   * Runs all members of a study, each alone and as a process of its own, and
   * writes what they gave and cost: study.csv, study.json, the error against
   * the time as a plot, and for each error reached the cheapest settings as a
   * piece of a .prm. What has been run is not run again. Run as one process,
   * before MPI is started.
   * @param program this program
   * @return exit code: 0, or 2 when no member ran to its end.
   * @throw SceneError for a scene that is refused, OutputError.
   */
  int
  run_study(const Study &study, const std::string &program);
} // namespace selkie
