#pragma once

#include <selkie/output/difference.h>
#include <selkie/output/run_folder.h>

#include <string>
#include <vector>

namespace selkie
{
  /// What two runs differ in. The order counts: norms, points and times are
  /// those of A.
  struct Comparison
  {
    RunFolder               a, b;
    std::vector<Difference> differences;
  };

  /**
   * Compares the output folders of two finished runs, on any point sets and
   * time steps: their probes and statistics.csv (compare_curves()) and the
   * fields of particles.pvd (compare_fields()).
   * @throw SceneError if a folder is not one of a run of Selkie, has a file
   * that cannot be read, if the dimensions differ, or if the runs share
   * nothing that could be compared.
   */
  Comparison
  compare_runs(const std::string &folder_a, const std::string &folder_b);

  /**
   * Writes `directory`/compare.csv, making the folder where it does not exist;
   * nothing is overwritten but an earlier compare.csv of this command.
   * @param directory empty: compare_NAME-OF-B in A's folder
   * @return the file's path
   * @throw SceneError if it cannot be written.
   */
  std::string
  write_comparison(const Comparison  &comparison,
                   const std::string &directory = "");

  /// The differences over all times, as a table for the screen.
  std::string
  comparison_table(const Comparison &comparison);
} // namespace selkie
