#include <selkie/adapt/flag_cells.h>
#include <selkie/base/types.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    using Cell = typename NodeCloud<dim>::Cell;

    /// The levels that the owned cells will have, by active cell index.
    using Targets = std::vector<unsigned int>;

    template <int dim, typename Action>
    void
    for_owned(const parallel::distributed::Triangulation<dim> &mesh,
              const Action                                    &action)
    {
      for (const auto &cell : mesh.active_cell_iterators())
        if (cell->is_locally_owned())
          action(cell);
    }

    /// The level of a cell by what is wanted there. What is fine stays so while
    /// something as fine is wanted within the cell's own width: matter that
    /// goes to and fro does not take the mesh with it.
    template <int dim>
    unsigned int
    wish(const Cell<dim>         &cell,
         const WantedLevels<dim> &wanted,
         const LeastLevel<dim>   &least_level)
    {
      const unsigned int level = cell->level();
      auto               box   = cell->bounding_box();
      const unsigned int here  = wanted.level(box);
      if (here >= level)
        return here;
      box.extend(box.side_length(0));
      return std::min(level, std::max(wanted.level(box), least_level(cell)));
    }

    /// What each cell wants by itself.
    template <int dim>
    Targets
    wishes(const parallel::distributed::Triangulation<dim> &mesh,
           const WantedLevels<dim>                         &wanted,
           const LeastLevel<dim>                           &least_level)
    {
      Targets targets(mesh.n_active_cells());
      for_owned(mesh, [&](const Cell<dim> &cell) {
        targets[cell->active_cell_index()] = wish(cell, wanted, least_level);
      });
      return targets;
    }

    /// One level up, if at all, or down; whether some cell wants more.
    template <int dim>
    bool
    take_one_level(const parallel::distributed::Triangulation<dim> &mesh,
                   const bool                                       refines,
                   Targets                                         &targets)
    {
      bool more = false;
      for_owned(mesh, [&](const Cell<dim> &cell) {
        const unsigned int level  = cell->level();
        unsigned int      &target = targets[cell->active_cell_index()];
        const unsigned int all    = target;
        target = std::clamp(all, level > 0 ? level - 1 : 0, level + refines);
        more   = more || target != all;
      });
      return Utilities::MPI::max<int>(more, mesh.get_communicator()) > 0;
    }

    /// The finest target of the cells around each node, on any rank.
    template <int dim>
    Vector
    finest_around(const parallel::distributed::Triangulation<dim> &mesh,
                  const NodeCloud<dim>                            &nodes,
                  const Targets                                   &targets)
    {
      Vector finest(nodes.partitioner());
      for_owned(mesh, [&](const Cell<dim> &cell) {
        const double target = targets[cell->active_cell_index()];
        for (const unsigned int node : nodes.corners(cell))
          finest.local_element(node) =
            std::max(finest.local_element(node), target);
      });
      finest.compress(VectorOperation::max);
      finest.update_ghost_values();
      return finest;
    }

    /// Whether all children of the cell's parent are to go. p4est keeps such
    /// families on one rank.
    template <int dim>
    bool
    family_goes(const Cell<dim> &cell, const Targets &targets)
    {
      if (cell->level() == 0)
        return false;
      const auto parent = cell->parent();
      for (unsigned int c = 0; c < parent->n_children(); ++c)
        {
          const auto child = parent->child(c);
          if (!child->is_active() || !child->is_locally_owned())
            return false;
          const typename Triangulation<dim>::active_cell_iterator sibling =
            child;
          if (int(targets[sibling->active_cell_index()]) >= cell->level())
            return false;
        }
      return true;
    }

    /// Raises targets until neighbours differ by one level at most and only
    /// whole families go: the smallest such raise, whatever the order.
    template <int dim>
    void
    balance(const parallel::distributed::Triangulation<dim> &mesh,
            const NodeCloud<dim>                            &nodes,
            Targets                                         &targets)
    {
      for (;;)
        {
          const Vector finest  = finest_around(mesh, nodes, targets);
          unsigned int changes = 0;
          for_owned(mesh, [&](const Cell<dim> &cell) {
            unsigned int &target = targets[cell->active_cell_index()];
            unsigned int  least  = target;
            for (const unsigned int node : nodes.corners(cell))
              least =
                std::max<int>(least,
                              std::lround(finest.local_element(node)) - 1);
            if (int(least) < cell->level() && !family_goes<dim>(cell, targets))
              least = cell->level();
            changes += least != target;
            target = least;
          });
          if (Utilities::MPI::sum(changes, mesh.get_communicator()) == 0)
            return;
        }
    }

    /// How many cells a mesh of these targets has, and how many change.
    template <int dim>
    CellFlags
    count(const parallel::distributed::Triangulation<dim> &mesh,
          const Targets                                   &targets)
    {
      CellFlags mine;
      for_owned(mesh, [&](const Cell<dim> &cell) {
        const int target = targets[cell->active_cell_index()];
        mine.refined += target > cell->level();
        mine.coarsened += target < cell->level();
      });
      const auto sum = [&mesh](const unsigned long long n) {
        return Utilities::MPI::sum(n, mesh.get_communicator());
      };
      constexpr unsigned int n_children = 1u << dim;
      CellFlags              all;
      all.refined   = sum(mine.refined);
      all.coarsened = sum(mine.coarsened);
      all.cells     = mesh.n_global_active_cells() +
                  (n_children - 1) * all.refined -
                  (n_children - 1) * (all.coarsened / n_children);
      return all;
    }
  } // namespace


  template <int dim>
  CellFlags
  flag_cells(parallel::distributed::Triangulation<dim> &mesh,
             const NodeCloud<dim>                      &nodes,
             const WantedLevels<dim>                   &wanted,
             const LeastLevel<dim>                     &least_level,
             const unsigned long long                   most_cells)
  {
    const Targets wished = wishes(mesh, wanted, least_level);
    Targets       targets;
    const auto    flags_if = [&](const bool refines) {
      targets         = wished;
      const bool more = take_one_level(mesh, refines, targets);
      balance(mesh, nodes, targets);
      CellFlags flags = count(mesh, targets);
      flags.more      = more;
      return flags;
    };
    CellFlags flags = flags_if(true);
    if (flags.cells > most_cells && flags.refined > 0)
      flags = flags_if(false);
    for_owned(mesh, [&targets](const Cell<dim> &cell) {
      const int target = targets[cell->active_cell_index()];
      if (target > cell->level())
        cell->set_refine_flag();
      else if (target < cell->level())
        cell->set_coarsen_flag();
    });
    return flags;
  }


#define INSTANTIATE(dim)                                                     \
  template CellFlags flag_cells(parallel::distributed::Triangulation<dim> &, \
                                const NodeCloud<dim> &,                      \
                                const WantedLevels<dim> &,                   \
                                const LeastLevel<dim> &,                     \
                                const unsigned long long)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
