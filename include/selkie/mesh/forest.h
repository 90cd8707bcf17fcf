#pragma once

#include <selkie/scene/scene.h>

#include <deal.II/distributed/p4est_wrappers.h>
#include <deal.II/distributed/tria.h>

#include <functional>
#include <memory>

namespace selkie
{
  /// p4est's cells of all ranks: coarse cells and how they are halved.
  template <int dim>
  using Forest = typename dealii::internal::p4est::types<dim>::forest;

  template <int dim>
  struct DestroyForest
  {
    void
    operator()(Forest<dim> *forest) const
    {
      dealii::internal::p4est::functions<dim>::destroy(forest);
    }
  };

  template <int dim>
  using ForestPointer = std::unique_ptr<Forest<dim>, DestroyForest<dim>>;

  /// The tree of p4est that a cell is part of. (CellId::get_coarse_cell_id() is
  /// that one already in deal.II 9.4, and not the index of the coarse cell.)
  template <int dim>
  unsigned int
  tree_of(const dealii::parallel::distributed::Triangulation<dim>  &mesh,
          const typename dealii::Triangulation<dim>::cell_iterator &cell);

  /// What a cell costs, or all children of one.
  template <int dim>
  using CellWeight = std::function<unsigned int(
    const typename dealii::Triangulation<dim>::cell_iterator &)>;

  /**
   * The cells that a mesh's flags ask for, shared out among the ranks so that
   * families stay together and can be joined. The mesh stays as it is.
   * @param weight of the cells that stay, of each child of those that are
   *   halved, and of the parent of those that are joined
   * The flags keep the balance (flag_cells()). Collective.
   */
  template <int dim>
  ForestPointer<dim>
  flagged_forest(const dealii::parallel::distributed::Triangulation<dim> &mesh,
                 const CellWeight<dim> &weight);

  /**
   * Makes the mesh anew with the cells of @p forest, on boxes of cells. Nothing
   * may hang on its cells: neither degrees of freedom nor points.
   *
   * Several times faster than execute_coarsening_and_refinement(), which keeps
   * the room of cells that are gone, walks through it, and would, for an order
   * of cells that has no history, first join all of them
   * (mesh_reconstruction_after_repartitioning). Collective.
   */
  template <int dim>
  void
  rebuild(const Domain<dim>                                 &domain,
          dealii::parallel::distributed::Triangulation<dim> &mesh,
          Forest<dim>                                       &forest);
} // namespace selkie
