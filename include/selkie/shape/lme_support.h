#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>
#include <selkie/shape/occupancy.h>
#include <selkie/shape/support_table.h>

#include <deal.II/lac/la_parallel_vector.h>

namespace selkie
{
  /**
   * Fills the table for LME-MPM with the material points: one patch per cell
   * and phase. In full fluid cells (Occupancy::enclosed at all corners) the
   * patch does not integrate: add_gauss_points() follows.
   * Throws OutsideHull.
   */
  template <int dim>
  void
  fill_material_points(const ParticleSet<dim> &particles,
                       const NodeCloud<dim>   &cloud,
                       const Occupancy<dim>   &occupancy,
                       SupportTable<dim>      &table);

  /// Shape functions at the Gauss points of cells, from step to step: they
  /// change only when a cell's nodes do.
  template <int dim>
  class GaussSupports
  {
  public:
    struct Cell
    {
      std::vector<unsigned int>     nodes;
      dealii::AlignedVector<double> values; ///< as in SupportTable::data
    };

    /// What is known of a cell; empty at first.
    Cell &
    of(const typename Patch<dim>::Cell &cell)
    {
      if (cells.size() <= cell->active_cell_index())
        cells.resize(cell->active_cell_index() + 1);
      return cells[cell->active_cell_index()];
    }

  private:
    std::vector<Cell> cells; ///< by active cell index
  };

  /**
   * Adds to each full fluid cell a patch of fixed Gauss points with the node
   * list of its material points: 2^dim, and where finer nodes reach into the
   * cell as many for each of their spacings. They have no history: J_n follows
   * from the pressure of the last step (quadrature.md, section 3).
   *
   * @param nodal_pressure at t_n, cloud numbering, with ghosts (Pa).
   * Throws OutsideHull.
   */
  template <int dim>
  void
  add_gauss_points(
    const NodeCloud<dim>                                     &cloud,
    const dealii::LinearAlgebra::distributed::Vector<double> &nodal_pressure,
    GaussSupports<dim>                                       &known,
    SupportTable<dim>                                        &table);

  /**
   * Adds to each cell with fluid a patch of 2^(dim-1) Gauss points for each of
   * its faces on the walls asked for, with their areas: for terms that act on
   * surfaces of the fluid. A cell that is filled in part has that part of its
   * faces. The points stand 1e-5 cells inside, where the
   * functions of LME can be computed.
   * Throws OutsideHull.
   */
  template <int dim>
  void
  add_wall_points(const NodeCloud<dim>            &cloud,
                  const std::array<bool, 2 * dim> &walls,
                  SupportTable<dim>               &table);
} // namespace selkie
