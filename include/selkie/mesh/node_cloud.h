#pragma once

#include <selkie/mesh/cell_locator.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/partitioner.h>
#include <deal.II/base/point.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>

#include <array>
#include <memory>
#include <vector>

namespace selkie
{
  /**
   * The nodes of the background mesh that this rank owns or can reach by LME.
   *
   * A node is a vertex of the triangulation, hanging ones included (LME needs
   * no hanging-node constraints). Nodes are numbered globally by a
   * DoFHandler of FE_Q(1); locally, the owned nodes come first, in the order
   * of their global numbers, then the halo, in that order too: the numbering
   * of partitioner(). The halo holds every node that lies within its own reach
   * R_a = h_a sqrt(-ln(tolerance)/gamma) of a cell that this rank owns; it is
   * wider than p4est's one ghost layer. It depends on mesh and partition only:
   * build a new cloud after each refinement or repartition.
   *
   * h_a is the smallest extent of the cells around the node.
   *
   * Where bodies must not share nodes (the effect `contact`), every vertex has
   * one node in each of several layers, with consecutive numbers.
   *
   * The mesh is one of make_background_mesh(). Construction is collective;
   * everything else is local.
   */
  template <int dim>
  class NodeCloud
  {
  public:
    using Cell = typename dealii::Triangulation<dim>::active_cell_iterator;

    NodeCloud(
      const dealii::parallel::distributed::Triangulation<dim> &triangulation,
      const double                                             lme_gamma,
      const double                                             tolerance,
      const unsigned int                                       n_layers = 1);

    /// For functions that live on cells (hat functions): the halo holds the
    /// nodes of this rank's cells and of its ghost cells, any mesh will do,
    /// and there is no reach(), beta() or nodes_near(). Positions are those in
    /// the mesh, h_a the shortest edge or diagonal around the node.
    explicit NodeCloud(
      const dealii::parallel::distributed::Triangulation<dim> &triangulation);
    ~NodeCloud();
    NodeCloud(const NodeCloud &) = delete;
    NodeCloud &
    operator=(const NodeCloud &) = delete;

    /// Owned nodes; the local indices [0, n_owned()).
    unsigned int
    n_owned() const;

    /// Owned and halo nodes; the local indices [0, size()).
    unsigned int
    size() const;

    const dealii::Point<dim> &
    position(const unsigned int node) const;

    /// h_a (m).
    double
    spacing(const unsigned int node) const;

    /// R_a (m).
    double
    reach(const unsigned int node) const;

    /// beta_a = gamma / h_a^2 (1/m^2).
    double
    beta(const unsigned int node) const;

    dealii::types::global_dof_index
    global_index(const unsigned int node) const;

    /// Number of nodes at each vertex.
    unsigned int
    n_layers() const
    {
      return layers;
    }

    unsigned int
    layer(const unsigned int node) const
    {
      return node % layers;
    }

    /// The node at the same vertex in another layer.
    unsigned int
    in_layer(const unsigned int node, const unsigned int layer) const
    {
      return node - node % layers + layer;
    }

    /// Number of nodes of the whole mesh.
    dealii::types::global_dof_index
    n_global() const;

    const std::shared_ptr<const dealii::Utilities::MPI::Partitioner> &
    partitioner() const;

    /// The numbering of the nodes, for output of nodal fields.
    const dealii::DoFHandler<dim> &
    dof_handler() const;

    /// The 2^dim corners of a locally owned cell, as local indices, in
    /// deal.II's vertex order.
    std::array<unsigned int, (1u << dim)>
    corners(const Cell &cell, const unsigned int layer = 0) const;

    /// All nodes whose reach touches the box of a locally owned cell, as local
    /// indices. Sorted by position (the last coordinate varies slowest), so
    /// that the list names the same nodes in the same order on any partition;
    /// global indices depend on it. Found once per cell and kept.
    const std::vector<unsigned int> &
    nodes_near(const Cell &cell) const;

    /// Number of cells of the mesh that have the node as a corner.
    unsigned int
    n_cells_around(const unsigned int node) const;

    /// The node's share of the cells around it (m^dim).
    double
    volume(const unsigned int node) const;

    /// Smallest h of the whole mesh (m).
    double
    smallest_spacing() const;

  private:
    struct Node;
    struct Tree;

    std::vector<Node>
    owned_nodes(const CellLocator<dim> &locator) const;
    std::vector<Node>
    halo_nodes(const std::vector<Node> &owned) const;
    void
    store_cell_nodes();
    void
    store(const std::vector<Node> &owned, const std::vector<Node> &halo);
    void
    store_corners();

    const double                                             gamma;
    const double                                             reach_per_spacing;
    const dealii::parallel::distributed::Triangulation<dim> &mesh;
    const unsigned int                                       layers;
    dealii::FESystem<dim>                                    element;
    dealii::DoFHandler<dim>                                  dofs;
    double                                                   smallest;

    std::vector<dealii::Point<dim>> positions;
    std::vector<double>             spacings, volumes;
    std::vector<unsigned int>       cells_around;
    /// Place of each local node in the order of positions.
    std::vector<unsigned int>   rank_of_position;
    std::unique_ptr<const Tree> tree; ///< boxes of the nodes' reaches

    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> partition;

    /// By active cell index; empty where not (yet) known.
    std::vector<std::array<unsigned int, (1u << dim)>> cell_corners;
    mutable std::vector<std::vector<unsigned int>>     near;
  };
} // namespace selkie
