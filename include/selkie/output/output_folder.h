#pragma once

#include <deal.II/base/mpi.h>

#include <string>

namespace selkie
{
  /**
   * Prepares the folder of a run: `directory` with solution/ and probes/,
   * original.prm (a copy of the scene's file) and parameters.prm (every value
   * used). Files of an earlier run of Selkie there are removed, all others
   * are left alone. Call it when the scene has passed all checks. Collective.
   * @param scene_file the .prm that was read
   * @param parameters text of parameters.prm
   * @throw SceneError, on all ranks, if the folder cannot be written.
   */
  void
  create_output_folder(const std::string &directory,
                       const std::string &scene_file,
                       const std::string &parameters,
                       const MPI_Comm     comm);

  /// The folder of a run that is resumed: only parameters.prm is written anew.
  /// Collective.
  /// @throw SceneError, on all ranks, if it cannot be written.
  void
  continue_output_folder(const std::string &directory,
                         const std::string &parameters,
                         const MPI_Comm     comm);

  /// Takes back the rows of statistics.csv and probes/*.csv that are later than
  /// time @p t (s). Collective.
  /// @throw OutputError, on all ranks, if a file cannot be written.
  void
  cut_tables(const std::string &directory, const double t, const MPI_Comm comm);
} // namespace selkie
