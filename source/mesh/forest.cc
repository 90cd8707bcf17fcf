#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/forest.h>

#include <deal.II/grid/cell_id.h>

#include <p4est_extended.h>
#include <p8est_extended.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    using P4est = internal::p4est::functions<dim>;
    template <int dim>
    using Quadrant = typename internal::p4est::types<dim>::quadrant;
    using Topidx   = p4est_topidx_t;

    enum class Wish
    {
      stay,
      refine,
      coarsen
    };

    /// What a quadrant is told; p4est leaves room for one number.
    struct Mark
    {
      unsigned int weight; ///< of what it becomes, see flagged_forest()
      Wish         wish;
    };

    template <typename Quadrant>
    void
    write_mark(const Mark mark, Quadrant *quadrant)
    {
      quadrant->p.user_int = 4 * mark.weight + static_cast<int>(mark.wish);
    }

    template <typename Quadrant>
    Mark
    read_mark(const Quadrant *quadrant)
    {
      const int number = quadrant->p.user_int;
      return {static_cast<unsigned int>(number / 4), Wish(number % 4)};
    }

    template <int dim>
    Mark
    mark_of(const typename Triangulation<dim>::cell_iterator &cell,
            const CellWeight<dim>                            &weight)
    {
      if (cell->refine_flag_set())
        return {weight(cell), Wish::refine};
      if (cell->coarsen_flag_set())
        return {weight(cell->parent()), Wish::coarsen};
      return {weight(cell), Wish::stay};
    }

    /// The place of a cell in its tree.
    template <int dim>
    Quadrant<dim>
    quadrant_of(const CellId &cell)
    {
      const auto    path  = cell.get_child_indices();
      std::uint64_t place = 0; // in p4est's order of the cells of this level
      for (const auto child : path)
        place = (place << dim) + child;
      Quadrant<dim> quadrant;
      P4est<dim>::quadrant_set_morton(&quadrant, path.size(), place);
      return quadrant;
    }

    template <int dim>
    void
    write_marks(const parallel::distributed::Triangulation<dim> &mesh,
                const CellWeight<dim>                           &weight,
                Forest<dim>                                     &forest)
    {
      using Tree = typename internal::p4est::types<dim>::tree;
      for (const auto &cell : mesh.active_cell_iterators())
        if (cell->is_locally_owned())
          {
            auto &quadrants =
              static_cast<Tree *>(
                sc_array_index(forest.trees, tree_of<dim>(mesh, cell)))
                ->quadrants;
            auto       quadrant = quadrant_of<dim>(cell->id());
            const auto place    = sc_array_bsearch(&quadrants,
                                                &quadrant,
                                                P4est<dim>::quadrant_compare);
            AssertThrow(place >= 0, ExcInternalError());
            write_mark(mark_of<dim>(cell, weight),
                       static_cast<Quadrant<dim> *>(
                         sc_array_index(&quadrants, place)));
          }
    }

    // p4est's callbacks:

    template <int dim>
    int
    is_refined(Forest<dim> *, Topidx, Quadrant<dim> *quadrant)
    {
      return read_mark(quadrant).wish == Wish::refine;
    }

    template <int dim>
    int
    is_coarsened(Forest<dim> *, Topidx, Quadrant<dim> *family[])
    {
      return std::all_of(family, family + (1 << dim), [](const auto *quadrant) {
        return read_mark(quadrant).wish == Wish::coarsen;
      });
    }

    template <int dim>
    void
    inherit(Forest<dim> *,
            Topidx,
            int,
            Quadrant<dim> *before[],
            int            n_after,
            Quadrant<dim> *after[])
    {
      const Mark mark{read_mark(before[0]).weight, Wish::stay};
      for (int i = 0; i < n_after; ++i)
        write_mark(mark, after[i]);
    }

    template <int dim>
    int
    weight_of(Forest<dim> *, Topidx, Quadrant<dim> *quadrant)
    {
      return read_mark(quadrant).weight;
    }

    template <int dim>
    void
    follow_marks(Forest<dim> &forest)
    {
      if constexpr (dim == 2)
        {
          p4est_refine_ext(
            &forest, false, -1, is_refined<dim>, nullptr, inherit<dim>);
          p4est_coarsen_ext(
            &forest, false, false, is_coarsened<dim>, nullptr, inherit<dim>);
        }
      else
        {
          p8est_refine_ext(
            &forest, false, -1, is_refined<dim>, nullptr, inherit<dim>);
          p8est_coarsen_ext(
            &forest, false, false, is_coarsened<dim>, nullptr, inherit<dim>);
        }
      P4est<dim>::partition(&forest, true, weight_of<dim>);
    }
  } // namespace


  template <int dim>
  unsigned int
  tree_of(const parallel::distributed::Triangulation<dim>  &mesh,
          const typename Triangulation<dim>::cell_iterator &cell)
  {
    auto root = cell;
    while (root->level() > 0)
      root = root->parent();
    return mesh.get_coarse_cell_to_p4est_tree_permutation()[root->index()];
  }


  template <int dim>
  ForestPointer<dim>
  flagged_forest(const parallel::distributed::Triangulation<dim> &mesh,
                 const CellWeight<dim>                           &weight)
  {
    auto *const        before = const_cast<Forest<dim> *>(mesh.get_p4est());
    ForestPointer<dim> forest(P4est<dim>::copy_forest(before, false));
    write_marks(mesh, weight, *forest);
    follow_marks<dim>(*forest);
    return forest;
  }


  template <int dim>
  void
  rebuild(const Domain<dim>                         &domain,
          parallel::distributed::Triangulation<dim> &mesh,
          Forest<dim>                               &forest)
  {
    reset_to_coarse_cells(domain, mesh);
    forest.connectivity = mesh.get_p4est()->connectivity; // the old one is gone
    mesh.load(&forest);
  }


#define INSTANTIATE(dim)                                             \
  template unsigned int tree_of<dim>(                                \
    const parallel::distributed::Triangulation<dim> &,               \
    const Triangulation<dim>::cell_iterator &);                      \
  template ForestPointer<dim> flagged_forest(                        \
    const parallel::distributed::Triangulation<dim> &,               \
    const CellWeight<dim> &);                                        \
  template void rebuild(const Domain<dim> &,                         \
                        parallel::distributed::Triangulation<dim> &, \
                        Forest<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
