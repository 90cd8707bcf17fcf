#pragma once

#include <selkie/adapt/criteria.h>
#include <selkie/transfer/carried_fields.h>

namespace selkie
{
  /// What an adaptation did, on all ranks.
  struct AdaptReport
  {
    bool changed = false; ///< the mesh or its partition: build what hangs on it
    double energy = 0;    ///< by splitting and merging points (J), if audited
  };

  /**
   * Adapts the background mesh to the matter (effect `adaptivity`): refines
   * and coarsens until every cell has the level that the criteria want, shares
   * it out among the ranks again, splits and merges points; with a Lagrangian
   * mesh these are Gauss points again, with the state that the nodes' fields
   * have there. The same on any number of ranks.
   * @param cloud of the mesh as it is; no longer valid after a change
   * @param nodes see NodalView
   * @param fields of the nodes; they go with the cells
   * Collective.
   */
  template <int dim>
  AdaptReport
  adapt_mesh(dealii::parallel::distributed::Triangulation<dim> &mesh,
             ParticleSet<dim>                                  &particles,
             const NodeCloud<dim>                              &cloud,
             const NodalView<dim>                              &nodes,
             CarriedFields<dim>                                &fields);
} // namespace selkie
