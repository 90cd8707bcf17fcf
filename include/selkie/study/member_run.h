#pragma once

#include <selkie/study/study.h>

#include <limits>
#include <map>
#include <string>
#include <vector>

namespace selkie
{
  /// What a run of a member gave and what it cost. A run that failed is a
  /// result too.
  struct MemberResult
  {
    std::string failure; ///< empty: done

    double quantity = std::numeric_limits<double>::quiet_NaN();
    double error    = std::numeric_limits<double>::quiet_NaN();

    double                        wall = 0, cpu = 0; ///< s, of the whole run
    std::map<std::string, double> phases;            ///< CPU s by phase
    double                        memory = 0; ///< peak of one process, MB
    double                        points = 0, unknowns = 0, steps = 0;
    double       newton = 0, linear = 0; ///< iterations, sums over the run
    double       lambda      = 0;        ///< iterations a point, mean
    double       balance     = 0;        ///< energy balance at the end (J; J/m)
    unsigned int timed_again = 0;        ///< how often time_again() has run it
  };

  /// The phases of MemberResult::phases, in order.
  const std::vector<std::string> &
  study_phases();

  /**
   * Runs a scene with settings as a child process, with its output in
   * @p folder and what it prints in folder.log. A folder in which the same
   * settings have been run to their end is not run again: its result is read.
   * In a study that repeats its timings, a short run is done up to five times
   * and the fastest counts.
   * @param program this program
   */
  MemberResult
  run_member(const Study       &study,
             const Settings    &settings,
             const std::string &folder,
             const std::string &program);

  /// Runs a member that has been run once more; the faster of the two is from
  /// now on what it cost. Its files stay those that run_member() left, and how
  /// often this was done is kept with its result, so that a study that is
  /// started again goes on with it instead of beginning anew.
  MemberResult
  time_again(const Study       &study,
             const Settings    &settings,
             const std::string &folder,
             const std::string &program);
} // namespace selkie
