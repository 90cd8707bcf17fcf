#pragma once

#include <deal.II/base/point.h>
#include <deal.II/distributed/tria.h>

#include <array>
#include <cstdint>

namespace selkie
{
  /**
   * Coordinates of a background mesh that is a refined lattice of equal boxes.
   *
   * Everything is computed from the box of the domain by operations that do
   * not depend on the partition, so all ranks agree bit by bit on where a
   * point lies. Cells are half open: a point on a face belongs to the cell on
   * its upper side, except at the domain's upper walls.
   */
  template <int dim>
  class CellLocator
  {
  public:
    using Triangulation = dealii::parallel::distributed::Triangulation<dim>;
    using Cell          = typename Triangulation::active_cell_iterator;
    /// Coordinates in units of the finest cells' extents.
    using Key = std::array<std::uint64_t, dim>;

    /// Throws unless the level-0 cells form a lattice of equal boxes.
    explicit CellLocator(const Triangulation &mesh);

    struct Location
    {
      Cell               cell; ///< may be owned, ghost or artificial
      dealii::Point<dim> reference;
    };

    /// The active cell, as far as this rank knows the mesh, around a point of
    /// the domain.
    Location
    locate(const dealii::Point<dim> &x) const;

    /// The centre of the finest possible cell around a point: well inside the
    /// active cell that locate() would find if this rank knew all cells.
    dealii::Point<dim>
    inside_cell(const dealii::Point<dim> &x) const;

    /// The lattice coordinates of a vertex.
    Key
    key(const dealii::Point<dim> &vertex) const;

    /// The position of a vertex, equal on all ranks.
    dealii::Point<dim>
    position(const Key &key) const;

    /// Smallest extent of a cell of this level (m).
    double
    spacing(const int level) const;

    /// Smallest h of the whole mesh (m).
    double
    smallest_spacing() const;

    const dealii::Point<dim> &
    lower() const
    {
      return low;
    }

    const dealii::Point<dim> &
    upper() const
    {
      return high;
    }

  private:
    /// How many finest cells there would be in a direction.
    double
    n_finest(const unsigned int direction) const;

    const Triangulation          &mesh;
    dealii::Point<dim>            low, high;
    std::array<unsigned int, dim> cells; ///< of level 0
    double                        smallest_coarse_extent;
    unsigned int                  finest_level;
  };
} // namespace selkie
