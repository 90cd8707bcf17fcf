#pragma once

#include <selkie/adapt/wanted_levels.h>
#include <selkie/mesh/node_cloud.h>

#include <functional>

namespace selkie
{
  /// What flag_cells() found, on all ranks.
  struct CellFlags
  {
    unsigned long long refined = 0, coarsened = 0; ///< cells so flagged
    unsigned long long cells = 0;                  ///< there will be so many
    bool more = false; ///< whether some want to change by another level

    bool
    any() const
    {
      return refined + coarsened > 0;
    }
  };

  /// The level that a cell has at least; its own level is not below that.
  template <int dim>
  using LeastLevel =
    std::function<unsigned int(const typename NodeCloud<dim>::Cell &)>;

  /**
   * Flags the cells whose level should change, one level at a time, so that
   * the new mesh is one where cells that share a corner differ by one level at
   * most. All of that is decided here, by the mesh alone: what deal.II would
   * add or drop for balance differs from one number of ranks to another.
   *
   * @param nodes of the mesh
   * @param least_level the level that a cell has if less is wanted
   * @param most_cells refines nothing if there would be more cells than that
   * Collective.
   */
  template <int dim>
  CellFlags
  flag_cells(dealii::parallel::distributed::Triangulation<dim> &mesh,
             const NodeCloud<dim>                              &nodes,
             const WantedLevels<dim>                           &wanted,
             const LeastLevel<dim>                             &least_level,
             const unsigned long long                           most_cells);
} // namespace selkie
