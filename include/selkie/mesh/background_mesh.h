#pragma once

#include <selkie/scene/scene.h>

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/tria.h>

#include <memory>

namespace selkie
{
  /**
   * The scene's mesh: a box of hypercubes on p4est, or one that the scene
   * imports (Lagrangian meshes only), refined where the scene asks for it, with
   * 2:1 balance over faces, edges and corners.
   * Boundary id = index of the wall (x-, x+, y-, …). The largest common power
   * of two of Domain::cells is made by global refinement, so that the coarse
   * mesh that every rank keeps is small. Particle counts are the weights of
   * the partition: the signal is connected by ParticleSet.
   */
  template <int dim>
  std::unique_ptr<dealii::parallel::distributed::Triangulation<dim>>
  make_background_mesh(const Domain<dim> &domain, const MPI_Comm comm);

  /// Leaves of such a mesh, whatever it is now, only the cells of p4est's
  /// trees, without any history: what is made of them next has its cells in
  /// the order that a program just started would give them. Collective.
  template <int dim>
  void
  reset_to_coarse_cells(
    const Domain<dim>                                 &domain,
    dealii::parallel::distributed::Triangulation<dim> &mesh);

  /// The level of the cells that Domain::cells counts.
  template <int dim>
  unsigned int
  base_level(const Domain<dim> &domain);

  /// The level that the scene's refinements want of a cell, at least.
  template <int dim>
  unsigned int
  refined_level(
    const Domain<dim>                                               &domain,
    const typename dealii::Triangulation<dim>::active_cell_iterator &cell);
} // namespace selkie
