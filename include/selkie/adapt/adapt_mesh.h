#pragma once

#include <selkie/adapt/criteria.h>
#include <selkie/adapt/flag_cells.h>
#include <selkie/adapt/wanted_levels.h>
#include <selkie/transfer/carried_fields.h>

namespace selkie
{
  /// What an adaptation did, on all ranks.
  struct AdaptReport
  {
    bool changed = false; ///< the mesh or its partition: build what hangs on it
    double energy = 0;    ///< by splitting and merging points (J), if audited
  };

  /// What an adaptation is to do; the mesh's cells carry the flags of its first
  /// change.
  template <int dim>
  struct AdaptPlan
  {
    WantedLevels<dim> wanted;
    CellFlags         first;
    bool              shares_out = false; ///< whether ranks hold too much

    /// Whether the mesh or its partition changes, or only points do.
    bool
    changes_mesh() const
    {
      return first.any() || shares_out;
    }
  };

  /**
   * Asks the scene's criteria (effect `adaptivity`) which cells should be finer
   * or coarser, and flags them. The same on any number of ranks.
   * @param cloud of the mesh
   * @param nodes see NodalView
   * Collective.
   */
  template <int dim>
  AdaptPlan<dim>
  plan_adaptation(dealii::parallel::distributed::Triangulation<dim> &mesh,
                  const ParticleSet<dim>                            &particles,
                  const NodeCloud<dim>                              &cloud,
                  const NodalView<dim>                              &nodes);

  /**
   * Adapts the background mesh to the matter: refines and coarsens until every
   * cell has the level that is wanted, shares it out among the ranks again,
   * splits and merges points; with a Lagrangian mesh these are Gauss points
   * again, with the state that the nodes' fields have there. The same on any
   * number of ranks.
   * @param plan of the mesh as it is. If it changes the mesh, a node cloud is
   *   no longer valid afterwards.
   * @param fields of the nodes; they go with the cells
   * Collective.
   */
  template <int dim>
  AdaptReport
  adapt_mesh(dealii::parallel::distributed::Triangulation<dim> &mesh,
             ParticleSet<dim>                                  &particles,
             const AdaptPlan<dim>                              &plan,
             CarriedFields<dim>                                &fields);
} // namespace selkie
