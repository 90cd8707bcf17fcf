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

  /**
   * Adds to each full fluid cell a patch of 2^dim fixed Gauss points with the
   * node list of its material points. They have no history: J_n follows from
   * the pressure of the last step (quadrature.md, section 3).
   *
   * @param nodal_pressure at t_n, cloud numbering, with ghosts (Pa).
   * Throws OutsideHull.
   */
  template <int dim>
  void
  add_gauss_points(
    const ParticleSet<dim>                                   &particles,
    const NodeCloud<dim>                                     &cloud,
    const dealii::LinearAlgebra::distributed::Vector<double> &nodal_pressure,
    SupportTable<dim>                                        &table);
} // namespace selkie
