#pragma once

#include <selkie/assembly/node_conditions.h>
#include <selkie/assembly/system_matrix.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/shape/occupancy.h>
#include <selkie/shape/support_table.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/partitioner.h>

#include <memory>
#include <vector>

namespace selkie
{
  /**
   * The unknowns of one step: dim displacement increments at every active
   * node and a pressure at those of fluids (and of solids, on request). Empty
   * cells have none.
   *
   * Each rank owns a contiguous range: first the displacements of its nodes
   * (node-major), then the pressures; nodes are taken line by line, by
   * position, so that those of a line follow each other in rows of the matrix.
   * Local indices are those of partitioner(): owned unknowns first, then
   * ghosts.
   */
  template <int dim>
  class System
  {
  public:
    System(const NodeCloud<dim>      &cloud,
           const NodeConditions<dim> &conditions,
           const unsigned int         pressure_phases);

    /// Numbers the unknowns anew; builds the sparsity pattern only when node
    /// lists or numbers have changed on some rank. Collective.
    void
    reinit(const Occupancy<dim> &occupancy, const SupportTable<dim> &table);

    /// Reads anew which unknowns the conditions hold; the pattern stays.
    void
    update_held();

    /// Local index of the first displacement component of a cloud node.
    unsigned int
    displacement(const unsigned int node) const
    {
      return u_index[node];
    }

    /// Local index of the pressure of a cloud node, or invalid_index.
    unsigned int
    pressure(const unsigned int node) const
    {
      return p_index.empty() ? invalid_index : p_index[node];
    }

    /// Owned nodes that carry unknowns, in the order of their unknowns.
    const std::vector<unsigned int> &
    owned_nodes() const
    {
      return nodes;
    }

    /// Owned nodes with a pressure, in the order of their pressures.
    const std::vector<unsigned int> &
    owned_pressure_nodes() const
    {
      return p_nodes;
    }

    /// Whether the unknown (local index) is prescribed.
    bool
    held(const unsigned int index) const
    {
      return is_held[index];
    }

    unsigned int
    n_owned() const
    {
      return n_u + n_p;
    }

    unsigned int
    n_owned_displacements() const
    {
      return n_u;
    }

    dealii::types::global_dof_index
    n_global() const
    {
      return partition->size();
    }

    dealii::types::global_dof_index
    n_global_pressures() const
    {
      return n_p_global;
    }

    const std::shared_ptr<const dealii::Utilities::MPI::Partitioner> &
    partitioner() const
    {
      return partition;
    }

    void
    initialize(Vector &vector) const
    {
      vector.reinit(partition);
    }

    /// The matrix of the present sparsity; its values are the assembler's.
    SystemMatrix &
    matrix()
    {
      return *tangent;
    }

    const SystemMatrix &
    matrix() const
    {
      return *tangent;
    }

    /// The same, for those who keep factors of it: each sparsity has a matrix
    /// of its own, which lives as long as somebody refers to it.
    std::shared_ptr<const SystemMatrix>
    shared_matrix() const
    {
      return tangent;
    }

    /// Local indices of the pressures at the corners of a cell.
    using CornerIndices = std::array<unsigned int, (1u << dim)>;

    /// False if a corner of the locally owned cell has no pressure.
    bool
    corner_pressures(const typename NodeCloud<dim>::Cell &cell,
                     CornerIndices                       &indices) const;

    /// From now on there is a second matrix on the same unknowns, for the hat
    /// functions of the cells that hold points: a preconditioner's. Its
    /// sparsity is built when it is asked for, and with every new one of
    /// matrix(). Collective.
    void
    want_hats(const SupportTable<dim> &table);

    /// The hat functions' matrix of the present sparsity, or nullptr.
    const std::shared_ptr<SystemMatrix> &
    hats() const
    {
      return hat_tangent;
    }

    unsigned int
    n_sparsity_builds() const
    {
      return sparsity_builds;
    }

    const NodeCloud<dim>      &cloud;
    const NodeConditions<dim> &conditions;

  private:
    void
    number_unknowns(const Occupancy<dim>    &occupancy,
                    const SupportTable<dim> &table);
    /// Nodes that couple with each other: their displacements, and their
    /// pressures in the lists of matter that has one.
    struct Coupling
    {
      const unsigned int *begin, *end;
      bool                pressure;
    };
    std::shared_ptr<SystemMatrix>
    make_matrix(const std::vector<Coupling> &couplings) const;
    void
    build_sparsity(const SupportTable<dim> &table);
    void
    build_hats(const SupportTable<dim> &table);
    std::size_t
    structure_hash(const SupportTable<dim> &table) const;

    const unsigned int pressure_phases; ///< those with pressures, bits

    std::vector<unsigned int>       by_position; ///< owned nodes
    std::vector<unsigned int>       nodes, p_nodes, u_index, p_index;
    std::vector<bool>               is_held;
    unsigned int                    n_u = 0, n_p = 0;
    dealii::types::global_dof_index n_p_global = 0;

    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> partition;
    std::shared_ptr<SystemMatrix> tangent, hat_tangent;
    std::size_t                   last_hash       = 0;
    unsigned int                  sparsity_builds = 0;
    bool                          hats_wanted     = false;
  };
} // namespace selkie
