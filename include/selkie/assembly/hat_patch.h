#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/terms/patch_state.h>

namespace selkie
{
  /**
   * A patch as the hat functions of its cell see it, for the matrix of a
   * preconditioner (solver.md, section 2): what the terms left at the points,
   * spread evenly over the Gauss points of the cell, and the corners of the
   * cell as nodes.
   *
   * Spread, because hat functions do not reach as far as LME: where a cell is
   * cut, a corner far from its points has next to no weight in the one and a
   * good one in the other, and the preconditioner would take the node for far
   * too soft (cantilever, 16k points, bent: 28 iterations instead of 10).
   *
   * Cells are axis-parallel boxes.
   */
  template <int dim>
  class HatPatch
  {
  public:
    /// Has a table and patch of its own, and forms; valid until the next call.
    const PatchState<dim> &
    of(const PatchState<dim> &state, const NodeCloud<dim> &cloud);

  private:
    void
    set_functions(const dealii::Tensor<1, dim> &cell_size);

    SupportTable<dim>      table;
    PatchState<dim>        spread;
    dealii::Tensor<1, dim> size; ///< of the cell in the table (m)
  };
} // namespace selkie
