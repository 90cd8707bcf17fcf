#pragma once

#include <selkie/assembly/node_conditions.h>
#include <selkie/assembly/point_tangent.h>
#include <selkie/assembly/system_matrix.h>
#include <selkie/base/bits.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/shape/occupancy.h>
#include <selkie/shape/support_table.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/partitioner.h>

#include <bitset>
#include <memory>
#include <vector>

namespace selkie
{
  /// What there is of a tangent.
  struct TangentParts
  {
    bool matrix = true;  ///< System::matrix(), else System::points()
    bool hats   = false; ///< System::hats() as well
  };

  /**
   * The unknowns of one step: dim displacement increments at every active
   * node, and there a pressure for each phase around it that has pressures:
   * fluids (and solids, on request). Phases share displacements, but pressures
   * jump at their interface. Empty cells have none.
   *
   * Each rank owns a contiguous range: first the displacements of its nodes
   * (node-major), then the pressures (those of a node follow each other, by
   * phase); nodes are taken line by line, by
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

    /// Numbers the unknowns anew; matrices are lost when node lists or numbers
    /// have changed on some rank. Collective.
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

    /// Local index of the pressure that a phase has at a cloud node of its
    /// own. The phase must have pressures.
    unsigned int
    pressure(const unsigned int node, const unsigned int phase) const
    {
      const unsigned int before = p_phases[node] & ((1u << phase) - 1u);
      return p_index[node] +
             static_cast<unsigned int>(std::bitset<32>(before).count());
    }

    /// Local index of the first pressure of a cloud node (that of the fluid,
    /// where there is one), or invalid_index.
    unsigned int
    first_pressure(const unsigned int node) const
    {
      return p_index.empty() ? invalid_index : p_index[node];
    }

    /// Owned nodes that carry unknowns, in the order of their unknowns.
    const std::vector<unsigned int> &
    owned_nodes() const
    {
      return nodes;
    }

    /// Whose a pressure is.
    struct PressureOf
    {
      unsigned int node, phase;
    };

    /// Those of owned nodes, in the order of their unknowns.
    const std::vector<PressureOf> &
    owned_pressures() const
    {
      return pressures;
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

    /// From now on the tangent is a matrix. Its sparsity is built unless there
    /// is one that fits. Collective.
    void
    want_matrix(const SupportTable<dim> &table);

    /// From now on the tangent stays at the points: there is no matrix.
    void
    want_points();

    /// The tangent at the points, or nullptr if it is a matrix.
    PointTangent<dim, double> *
    points() const
    {
      return point_tangent.get();
    }

    /// y = K x with the tangent as it is. Collective.
    void
    vmult(Vector &y, const Vector &x) const
    {
      if (point_tangent)
        point_tangent->vmult(y, x);
      else
        tangent->vmult(y, x);
    }

    /// The matrix of the present sparsity, once it was wanted; its values are
    /// the assembler's.
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

    /// Entries of the matrix; zero without one.
    unsigned long long
    n_nonzero_elements() const
    {
      return tangent ? tangent->n_nonzero_elements() : 0;
    }

    /// Local indices of the pressures at the corners of a cell.
    using CornerIndices = std::array<unsigned int, (1u << dim)>;

    /// False if a corner of the locally owned cell has no pressure of the
    /// phase.
    bool
    corner_pressures(const typename NodeCloud<dim>::Cell &cell,
                     const unsigned int                   phase,
                     CornerIndices                       &indices) const;

    /// From now on (or no longer) tangents come with a second matrix on the
    /// same unknowns, for the hat functions of the cells that hold points: a
    /// preconditioner's. Its sparsity is kept for a next time. Collective.
    void
    want_hats(const bool wanted, const SupportTable<dim> &table);

    /// The hat functions' matrix, or nullptr if it is not wanted.
    std::shared_ptr<SystemMatrix>
    hats() const
    {
      return hats_wanted ? hat_tangent : nullptr;
    }

    /// How often node lists or numbers have changed.
    unsigned int
    n_structures() const
    {
      return structures;
    }

    const NodeCloud<dim>      &cloud;
    const NodeConditions<dim> &conditions;
    const unsigned int         pressure_phases; ///< with pressures, as bits

  private:
    void
    number_unknowns(const Occupancy<dim>    &occupancy,
                    const SupportTable<dim> &table);
    /// Nodes that couple with each other: their displacements and, in the
    /// lists of matter that has them, the pressures of its phase.
    struct Coupling
    {
      const unsigned int *begin, *end;
      bool                pressure;
      unsigned int        phase;
    };
    std::shared_ptr<SystemMatrix>
    make_matrix(const std::vector<Coupling> &couplings) const;
    std::size_t
    structure_hash(const SupportTable<dim> &table) const;

    std::vector<unsigned int>       by_position; ///< owned nodes
    std::vector<unsigned int>       nodes, u_index, p_index;
    std::vector<PressureOf>         pressures;
    std::vector<unsigned int>       p_phases; ///< of a node's pressures, bits
    std::vector<bool>               is_held;
    unsigned int                    n_u = 0, n_p = 0;
    dealii::types::global_dof_index n_p_global = 0;

    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> partition;
    std::shared_ptr<SystemMatrix>              tangent, hat_tangent;
    std::unique_ptr<PointTangent<dim, double>> point_tangent;
    bool                                       hats_wanted = false;
    std::size_t                                last_hash   = 0;
    unsigned int                               structures  = 0;
  };
} // namespace selkie
