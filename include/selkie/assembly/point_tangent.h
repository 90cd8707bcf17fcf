#pragma once

#include <selkie/assembly/point_forms.h>
#include <selkie/base/types.h>
#include <selkie/terms/patch_state.h>

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/partitioner.h>
#include <deal.II/base/subscriptor.h>

#include <memory>
#include <vector>

namespace selkie
{
  template <int dim>
  class System;

  /// Whose unknowns the patches of a PointTangent reach, and where they are.
  struct PointTangentLayout
  {
    /// A patch. Its functions are n_rows rows a point: N if there is mass or a
    /// pressure, and the gradients.
    struct Cell
    {
      unsigned int n_points, n_nodes, n_padded, n_rows;
      bool         mass, pressure;
      unsigned int first_node;           ///< in first_unknowns
      unsigned int first_pressure;       ///< in pressures
      unsigned int first_forms;          ///< of its points
      unsigned int first_pressure_forms; ///< the same
      std::size_t  functions, stride; ///< of its first point, to the next one
    };

    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> partition;

    unsigned int              n_displacements = 0; ///< owned
    std::vector<Cell>         cells;
    std::vector<unsigned int> first_unknowns; ///< of each node of a list
    std::vector<unsigned int> pressures;      ///< the same, where there are
    std::vector<bool>         is_held;        ///< by local unknown
    std::vector<unsigned int> held;           ///< the owned ones
  };

  /**
   * The tangent of a System, left at the points instead of summed into a
   * matrix: with what the terms leave there (PointForm), and what they leave at
   * nodes on a diagonal,
   *
   *   y_a   = sum_q (stiffness_q : sum_b x_b (x) G_b + coupling_q p_q) G_a
   *               + mass_q (sum_b N_b x_b) N_a  + diagonal_a x_a,
   *   y_p,a = sum_q (coupling_q : sum_b x_b (x) G_b
   *               + (p_stiffness_q - lumped_q) p_q) N_a  + diagonal_p,a p_a,
   *
   * with p_q = sum_b N_b p_b where there are pressures, patch by patch. As in a
   * SystemMatrix, rows and columns of prescribed unknowns keep their diagonal
   * only. A product takes up to twice that with the matrix, but to assemble the
   * matrix takes twenty products in 2D and a hundred in 3D (doc/performance.md,
   * "Matrix-free or not").
   *
   * In double precision it is filled by the assembler and reads the functions
   * in the support table, which must outlive it; in single precision, for
   * preconditioners, it is a copy of the displacements' block that depends on
   * nothing. (For the other blocks: PointCoupling.)
   */
  template <int dim, typename Number>
  class PointTangent : public dealii::Subscriptor
  {
  public:
    using VectorType = dealii::LinearAlgebra::distributed::Vector<Number>;

    PointTangent() = default;

    /// A copy without the pressures, with its own copy of the functions.
    explicit PointTangent(const PointTangent<dim, double> &other);

    /// Empties it, for the unknowns of a system and patches of a table.
    /// @param pressure_unit of the pressures' unknowns and equations (Pa)
    void
    begin(const System<dim>       &system,
          const SupportTable<dim> &table,
          const double             pressure_unit);

    /// Takes what the terms left at the points of a patch.
    /// @param unknowns of the patch, component-major, the pressures last
    /// @param with_mass whether PointForm::mass may differ from zero
    /// @param with_pressure whether the patch has pressures
    void
    add(const std::vector<unsigned int> &unknowns,
        const PatchState<dim>           &state,
        const bool                       with_mass,
        const bool                       with_pressure);

    /// Adds to the diagonal of owned rows.
    void
    add_diagonal(const Vector &more);

    /// Sends what belongs to other ranks. Collective.
    void
    finish();

    /// y = K x in the owned rows; vectors in the system's layout. Collective.
    void
    vmult(VectorType &y, const VectorType &x) const;

    /// The diagonal blocks of the owned nodes' displacements, in their order.
    /// Collective.
    std::vector<dealii::Tensor<2, dim, Number>>
    node_blocks() const;

    /// The system's layout.
    const std::shared_ptr<const dealii::Utilities::MPI::Partitioner> &
    partitioner() const
    {
      return layout.partition;
    }

    /// In the system's layout.
    void
    initialize(VectorType &vector) const
    {
      vector.reinit(layout.partition);
    }

    /// What it holds, on this rank (bytes).
    std::size_t
    memory_consumption() const;

  private:
    template <int, typename>
    friend class PointTangent;
    template <int>
    friend class PointCoupling;

    using Lanes                         = simd::NativeOf<Number>;
    static constexpr unsigned int lanes = sizeof(Lanes) / sizeof(Number);
    using Cell                          = PointTangentLayout::Cell;

    Cell
    add_cell(Cell cell);
    void
    copy_forms(const PointTangent<dim, double> &other,
               const Cell                      &from,
               const Cell                      &to);
    void
    add_pressures(const std::vector<unsigned int> &unknowns,
                  const PatchState<dim>           &state,
                  const Cell                      &cell);
    void
    add_held_diagonal(const Cell &cell);

    // Of one patch.
    const Number *
    N(const Cell &cell) const
    {
      return functions + cell.functions;
    }
    const Number *
    G(const Cell &cell) const
    {
      return N(cell) + (cell.n_rows - dim) * cell.n_padded;
    }
    void
    gather(const Cell &cell) const;
    template <bool mass, bool pressure>
    void
    multiply(const Cell &cell, Number *y) const;
    void
    find_blocks(const Cell        &cell,
                const unsigned int a,
                Lanes (&blocks)[dim][dim]) const;
    template <typename Action>
    void
    for_each_block(const Cell &cell, const Action &action) const;
    template <typename Action>
    void
    for_each_pressure(const Cell &cell, const Action &action) const;

    PointTangentLayout layout;
    double             unit = 1; ///< of pressures (Pa)
    VectorType         diagonal;

    std::vector<PointForms<dim, Lanes>>    forms;
    std::vector<PressureForms<dim, Lanes>> pressure_forms;

    const Number                 *functions = nullptr;
    dealii::AlignedVector<Number> own_functions; ///< of a copy

    // Scratch: a vector with its ghosts, and what belongs to one patch.
    mutable VectorType                    wide;
    mutable dealii::AlignedVector<Number> values, fluxes;
  };
} // namespace selkie
