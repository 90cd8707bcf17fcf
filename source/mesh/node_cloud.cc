#include <selkie/base/types.h>
#include <selkie/mesh/node_cloud.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/boost_adaptors/bounding_box.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/numerics/rtree.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace selkie
{
  /// What a rank tells another about one of its nodes.
  template <int dim>
  struct NodeCloud<dim>::Node
  {
    dealii::types::global_dof_index index;
    typename CellLocator<dim>::Key  key; ///< integer position
    dealii::Point<dim>              x;
    double                          h = 0;

    template <class Archive>
    void
    serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &index &key &x &h;
    }

    bool
    operator<(const Node &other) const
    {
      return index < other.index;
    }
  };


  namespace
  {
    template <int dim>
    using BoxTree =
      dealii::RTree<std::pair<dealii::BoundingBox<dim>, unsigned int>>;

    template <int dim, typename Cell>
    dealii::BoundingBox<dim>
    box_of(const Cell &cell)
    {
      return dealii::BoundingBox<dim>(
        {cell->vertex(0), cell->vertex((1u << dim) - 1)});
    }

    template <int dim>
    dealii::BoundingBox<dim>
    box_around(const dealii::Point<dim> &x, const double reach)
    {
      dealii::Point<dim> lower = x, upper = x;
      for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] -= reach;
          upper[d] += reach;
        }
      return dealii::BoundingBox<dim>({lower, upper});
    }

    /// A node whose distance is its reach up to round-off is near on any rank.
    template <int dim>
    bool
    is_near(const dealii::Point<dim>       &x,
            const double                    reach,
            const dealii::BoundingBox<dim> &box)
    {
      double square = 0;
      for (unsigned int d = 0; d < dim; ++d)
        {
          const double outside = std::max(
            {box.lower_bound(d) - x[d], x[d] - box.upper_bound(d), 0.});
          square += outside * outside;
        }
      return square <= reach * reach;
    }

    /// The nodes whose reach boxes meet a box.
    template <int dim>
    std::vector<std::pair<dealii::BoundingBox<dim>, unsigned int>>
    query(const BoxTree<dim> &tree, const dealii::BoundingBox<dim> &box)
    {
      namespace bgi = boost::geometry::index;
      std::vector<std::pair<dealii::BoundingBox<dim>, unsigned int>> found;
      tree.query(bgi::intersects(box), std::back_inserter(found));
      return found;
    }

    /// A handful of boxes that cover all boxes of the tree.
    template <int dim>
    std::vector<dealii::BoundingBox<dim>>
    cover(const BoxTree<dim> &tree)
    {
      if (tree.empty())
        return {};
      auto boxes = dealii::extract_rtree_level(tree, 1);
      if (boxes.empty()) // a small tree: one leaf without inner nodes
        for (const auto &entry : tree)
          boxes.push_back(entry.first);
      return boxes;
    }
  } // namespace


  template <int dim>
  struct NodeCloud<dim>::Tree
  {
    BoxTree<dim> boxes;
  };


  template <int dim>
  NodeCloud<dim>::NodeCloud(
    const dealii::parallel::distributed::Triangulation<dim> &triangulation,
    const double                                             lme_gamma,
    const double                                             tolerance,
    const unsigned int                                       n_layers)
    : gamma(lme_gamma)
    // the last factor lets all ranks agree on nodes at exactly their reach
    , reach_per_spacing(std::sqrt(-std::log(tolerance) / lme_gamma) *
                        (1. + 1e-10))
    , mesh(triangulation)
    , layers(n_layers)
    , element(dealii::FE_Q<dim>(1), layers)
    , dofs(triangulation)
  {
    const CellLocator<dim> locator(mesh);
    smallest = locator.smallest_spacing();
    dofs.distribute_dofs(element);
    const std::vector<Node> owned = owned_nodes(locator);
    const std::vector<Node> halo  = halo_nodes(owned);
    store(owned, halo);
    store_corners();
    near.resize(mesh.n_active_cells());
  }


  template <int dim>
  NodeCloud<dim>::NodeCloud(
    const dealii::parallel::distributed::Triangulation<dim> &triangulation)
    : gamma(0.)
    , reach_per_spacing(0.)
    , mesh(triangulation)
    , layers(1)
    , element(dealii::FE_Q<dim>(1), layers)
    , dofs(triangulation)
  {
    dofs.distribute_dofs(element);
    store_cell_nodes();
    store_corners();
  }


  template <int dim>
  NodeCloud<dim>::~NodeCloud() = default;


  template <int dim>
  void
  NodeCloud<dim>::store_cell_nodes()
  {
    dealii::IndexSet relevant;
    dealii::DoFTools::extract_locally_relevant_dofs(dofs, relevant);
    partition = std::make_shared<const dealii::Utilities::MPI::Partitioner>(
      dofs.locally_owned_dofs(), relevant, mesh.get_communicator());
    const unsigned int n =
      partition->locally_owned_size() + partition->n_ghost_indices();
    positions.resize(n);
    Vector h(partition);
    h = std::numeric_limits<double>::max();
    std::vector<dealii::types::global_dof_index> indices(1u << dim);
    for (const auto &cell : dofs.active_cell_iterators())
      if (!cell->is_artificial())
        {
          cell->get_dof_indices(indices);
          for (unsigned int v = 0; v < indices.size(); ++v)
            {
              const auto node       = partition->global_to_local(indices[v]);
              positions[node]       = cell->vertex(v);
              h.local_element(node) = std::min(h.local_element(node),
                                               cell->minimum_vertex_distance());
            }
        }
    // Owned nodes see all cells around them, ghosts take the owners' word.
    h.zero_out_ghost_values();
    h.update_ghost_values();
    smallest = std::numeric_limits<double>::max();
    for (unsigned int node = 0; node < n; ++node)
      {
        spacings.push_back(h.local_element(node));
        smallest = std::min(smallest, spacings.back());
      }
    smallest = dealii::Utilities::MPI::min(smallest, mesh.get_communicator());
  }


  template <int dim>
  std::vector<typename NodeCloud<dim>::Node>
  NodeCloud<dim>::owned_nodes(const CellLocator<dim> &locator) const
  {
    const dealii::IndexSet &owned = dofs.locally_owned_dofs();
    std::vector<Node>       nodes(owned.n_elements());
    std::vector<dealii::types::global_dof_index> indices(
      element.n_dofs_per_cell());
    for (const auto &cell : dofs.active_cell_iterators())
      if (!cell->is_artificial())
        {
          const double h = locator.spacing(cell->level());
          cell->get_dof_indices(indices);
          for (unsigned int v = 0; v < indices.size(); ++v)
            if (owned.is_element(indices[v]))
              {
                Node &node = nodes[owned.index_within_set(indices[v])];
                node.index = indices[v];
                node.key   = locator.key(cell->vertex(v / layers));
                node.h     = node.h > 0 ? std::min(node.h, h) : h;
              }
        }
    for (Node &node : nodes)
      node.x = locator.position(node.key);
    return nodes;
  }


  /**
   * Two exchanges. Each rank publishes a few boxes that cover the reaches of
   * its nodes; every other rank answers with those of its cells that meet
   * them, and is sent the nodes whose reach touches one of these cells.
   */
  template <int dim>
  std::vector<typename NodeCloud<dim>::Node>
  NodeCloud<dim>::halo_nodes(const std::vector<Node> &owned) const
  {
    using Box               = dealii::BoundingBox<dim>;
    const MPI_Comm     comm = mesh.get_communicator();
    const unsigned int me   = dealii::Utilities::MPI::this_mpi_process(comm);

    std::vector<std::pair<Box, unsigned int>> reaches, cells;
    for (unsigned int i = 0; i < owned.size(); ++i)
      reaches.emplace_back(box_around(owned[i].x,
                                      owned[i].h * reach_per_spacing),
                           i);
    for (const auto &cell : mesh.active_cell_iterators())
      if (cell->is_locally_owned())
        cells.emplace_back(box_of<dim>(cell), cells.size());
    const BoxTree<dim> node_tree(reaches.begin(), reaches.end());
    const BoxTree<dim> cell_tree(cells.begin(), cells.end());

    const auto covers =
      dealii::Utilities::MPI::all_gather(comm, cover<dim>(node_tree));
    std::map<unsigned int, std::vector<Box>> requests;
    for (unsigned int rank = 0; rank < covers.size(); ++rank)
      if (rank != me)
        {
          std::vector<bool> sent(cells.size(), false);
          for (const Box &box : covers[rank])
            for (const auto &[cell, i] : query<dim>(cell_tree, box))
              if (!sent[i])
                {
                  sent[i] = true;
                  requests[rank].push_back(cell);
                }
        }

    std::map<unsigned int, std::vector<Node>> answers;
    for (const auto &[rank, boxes] :
         dealii::Utilities::MPI::some_to_some(comm, requests))
      {
        std::vector<bool> sent(owned.size(), false);
        for (const Box &box : boxes)
          for (const auto &[reach, i] : query<dim>(node_tree, box))
            if (!sent[i] &&
                is_near(owned[i].x, owned[i].h * reach_per_spacing, box))
              {
                sent[i] = true;
                answers[rank].push_back(owned[i]);
              }
      }

    std::vector<Node> halo;
    for (const auto &[rank, nodes] :
         dealii::Utilities::MPI::some_to_some(comm, answers))
      halo.insert(halo.end(), nodes.begin(), nodes.end());
    std::sort(halo.begin(), halo.end());
    return halo;
  }


  template <int dim>
  void
  NodeCloud<dim>::store(const std::vector<Node> &owned,
                        const std::vector<Node> &halo)
  {
    std::vector<Node> nodes = owned;
    nodes.insert(nodes.end(), halo.begin(), halo.end());

    dealii::IndexSet ghosts(dofs.n_dofs());
    for (const Node &node : halo)
      ghosts.add_index(node.index);
    ghosts.compress();
    partition = std::make_shared<const dealii::Utilities::MPI::Partitioner>(
      dofs.locally_owned_dofs(), ghosts, mesh.get_communicator());

    std::vector<std::pair<dealii::BoundingBox<dim>, unsigned int>> reaches;
    for (const Node &node : nodes)
      {
        reaches.emplace_back(box_around(node.x, node.h * reach_per_spacing),
                             positions.size());
        positions.push_back(node.x);
        spacings.push_back(node.h);
      }
    tree.reset(new Tree{BoxTree<dim>(reaches.begin(), reaches.end())});

    std::vector<unsigned int> order(nodes.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(),
              order.end(),
              [&nodes](const unsigned int a, const unsigned int b) {
                const auto &x = nodes[a].key, &y = nodes[b].key;
                if (x == y) // in different layers
                  return a < b;
                return std::lexicographical_compare(x.rbegin(),
                                                    x.rend(),
                                                    y.rbegin(),
                                                    y.rend());
              });
    rank_of_position.resize(nodes.size());
    for (unsigned int i = 0; i < order.size(); ++i)
      rank_of_position[order[i]] = i;
  }


  template <int dim>
  void
  NodeCloud<dim>::store_corners()
  {
    cell_corners.resize(mesh.n_active_cells());
    std::vector<dealii::types::global_dof_index> indices(
      element.n_dofs_per_cell());
    for (const auto &cell : dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(indices);
          for (unsigned int v = 0; v < (1u << dim); ++v)
            cell_corners[cell->active_cell_index()][v] =
              partition->global_to_local(indices[v * layers]);
        }

    // Every cell tells its corners, on whatever rank their owners are.
    Vector share(partition), count(partition);
    for (const auto &cell : dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        for (unsigned int layer = 0; layer < layers; ++layer)
          for (const unsigned int node : corners(cell, layer))
            {
              share.local_element(node) += cell->measure() / (1u << dim);
              count.local_element(node) += 1.;
            }
    for (auto *vector : {&share, &count})
      {
        vector->compress(dealii::VectorOperation::add);
        vector->update_ghost_values();
      }
    volumes.resize(size());
    cells_around.resize(size());
    for (unsigned int node = 0; node < size(); ++node)
      {
        volumes[node]      = share.local_element(node);
        cells_around[node] = std::lround(count.local_element(node));
      }
  }


  template <int dim>
  unsigned int
  NodeCloud<dim>::n_owned() const
  {
    return partition->locally_owned_size();
  }


  template <int dim>
  unsigned int
  NodeCloud<dim>::size() const
  {
    return positions.size();
  }


  template <int dim>
  const dealii::Point<dim> &
  NodeCloud<dim>::position(const unsigned int node) const
  {
    AssertIndexRange(node, positions.size());
    return positions[node];
  }


  template <int dim>
  double
  NodeCloud<dim>::spacing(const unsigned int node) const
  {
    AssertIndexRange(node, spacings.size());
    return spacings[node];
  }


  template <int dim>
  double
  NodeCloud<dim>::reach(const unsigned int node) const
  {
    return reach_per_spacing * spacing(node);
  }


  template <int dim>
  double
  NodeCloud<dim>::beta(const unsigned int node) const
  {
    return gamma / (spacing(node) * spacing(node));
  }


  template <int dim>
  dealii::types::global_dof_index
  NodeCloud<dim>::global_index(const unsigned int node) const
  {
    return partition->local_to_global(node);
  }


  template <int dim>
  dealii::types::global_dof_index
  NodeCloud<dim>::n_global() const
  {
    return dofs.n_dofs();
  }


  template <int dim>
  const std::shared_ptr<const dealii::Utilities::MPI::Partitioner> &
  NodeCloud<dim>::partitioner() const
  {
    return partition;
  }


  template <int dim>
  const dealii::DoFHandler<dim> &
  NodeCloud<dim>::dof_handler() const
  {
    return dofs;
  }


  template <int dim>
  std::array<unsigned int, (1u << dim)>
  NodeCloud<dim>::corners(const Cell &cell, const unsigned int layer) const
  {
    Assert(cell->is_locally_owned(), dealii::ExcMessage("not an owned cell"));
    auto nodes = cell_corners[cell->active_cell_index()];
    for (unsigned int &node : nodes)
      node += layer;
    return nodes;
  }


  template <int dim>
  const std::vector<unsigned int> &
  NodeCloud<dim>::nodes_near(const Cell &cell) const
  {
    Assert(cell->is_locally_owned(), dealii::ExcMessage("not an owned cell"));
    std::vector<unsigned int> &nodes = near[cell->active_cell_index()];
    if (nodes.empty())
      {
        const auto box = box_of<dim>(cell);
        for (const auto &entry : query<dim>(tree->boxes, box))
          if (is_near(positions[entry.second], reach(entry.second), box))
            nodes.push_back(entry.second);
        std::sort(nodes.begin(),
                  nodes.end(),
                  [this](const unsigned int a, const unsigned int b) {
                    return rank_of_position[a] < rank_of_position[b];
                  });
        nodes.shrink_to_fit();
      }
    return nodes;
  }


  template <int dim>
  unsigned int
  NodeCloud<dim>::n_cells_around(const unsigned int node) const
  {
    AssertIndexRange(node, cells_around.size());
    return cells_around[node];
  }


  template <int dim>
  double
  NodeCloud<dim>::volume(const unsigned int node) const
  {
    AssertIndexRange(node, volumes.size());
    return volumes[node];
  }


  template <int dim>
  double
  NodeCloud<dim>::smallest_spacing() const
  {
    return smallest;
  }


  template class NodeCloud<2>;
  template class NodeCloud<3>;
} // namespace selkie
