#pragma once

#include <selkie/base/types.h>
#include <selkie/particles/particle_set.h>
#include <selkie/transfer/carried_fields.h>

#include <deal.II/dofs/dof_handler.h>

#include <map>
#include <string>

namespace selkie
{
  /// Where a run stood when a checkpoint was written.
  struct CheckpointState
  {
    double             time = 0; ///< s
    unsigned int       step = 0; ///< number of steps done
    double             dt   = 0; ///< of the next step (s)
    ParticleAccounting accounting;
    std::string        run; ///< what else the run carries, as bytes
  };

  /**
   * Writes `directory`/checkpoint/NNN/, NNN being the step: the mesh with the
   * material points and the nodes' fields, the handler's counters and
   * checkpoint.json (the state, number and mass of the points, the columns that
   * they carry, the names of the fields). When all of it is on disk,
   * `directory`/checkpoint/last_good is made to name it. The one that was last
   * good before is kept, older ones are removed. Collective.
   * @param dofs of FE_Q(1): the numbering of the nodes
   * @param nodal_fields what the nodes keep from step to step, with ghosts
   * @param run what else the run carries from step to step, as bytes
   * @return the checkpoint's folder
   * @throw OutputError, on all ranks, if it cannot be written.
   */
  template <int dim>
  std::string
  write_checkpoint(const std::string                                 &directory,
                   const Scene<dim>                                  &scene,
                   ParticleSet<dim>                                  &particles,
                   dealii::parallel::distributed::Triangulation<dim> &mesh,
                   const dealii::DoFHandler<dim>                     &dofs,
                   const std::map<std::string, const Vector *> &nodal_fields,
                   const double                                 time,
                   const unsigned int                           step,
                   const double                                 dt,
                   const std::string                           &run = "");

  /// A checkpoint to go on from.
  struct FoundCheckpoint
  {
    std::string folder;
    std::string damage; ///< of a later one that had to be passed over, or ""
  };

  /// The checkpoint that `directory`/checkpoint/last_good names or, if a file
  /// of it is missing or has not its size, the one before.
  /// @throw SceneError, with the reason, if there is none.
  FoundCheckpoint
  find_checkpoint(const std::string &directory);

  /**
   * Takes mesh, material points and the nodes' fields from a checkpoint, on any
   * number of ranks; what they were before is gone, so that the same file gives
   * the same, to the order of the cells. On as many ranks each gets the cells
   * that it had when the checkpoint was written, on others the points are
   * shared out anew. What hangs on the mesh must be gone before and built
   * afterwards. Collective.
   * @param folder of the checkpoint
   * @param nodal_fields filled, to the bit as they were written
   * @throw SceneError, on all ranks, if it is unreadable, or if its points do
   * not carry the columns that the scene asks for.
   */
  template <int dim>
  CheckpointState
  read_checkpoint(const std::string                                 &folder,
                  ParticleSet<dim>                                  &particles,
                  dealii::parallel::distributed::Triangulation<dim> &mesh,
                  CarriedFields<dim> &nodal_fields);
} // namespace selkie
