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
} // namespace selkie
