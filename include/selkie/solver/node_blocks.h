#pragma once

#include <selkie/assembly/system.h>

#include <deal.II/base/subscriptor.h>
#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <vector>

namespace selkie
{
  /// For preconditioners, on the unknowns' numbering: half the memory traffic.
  using FloatVector = dealii::LinearAlgebra::distributed::Vector<float>;

  /// A kind of unknowns.
  enum class Part
  {
    displacements,
    pressures
  };

  /**
   * The columns of a system's matrix as entries of vectors. Ghosts are all
   * columns that owned rows have: more than the system's own, as points of
   * other ranks couple owned nodes with nodes that this rank never meets.
   */
  struct ColumnLayout
  {
    template <int dim>
    explicit ColumnLayout(const System<dim> &system);

    FloatVector
    vector() const
    {
      FloatVector result;
      result.reinit(partition);
      return result;
    }

    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> partition;
    std::vector<unsigned int> entry_of; ///< by Epetra's local column index
    /// By entry: which displacement component, or invalid_index: a pressure.
    std::vector<unsigned int> component;
    unsigned int              n_u, n; ///< owned displacements, unknowns
  };

  /**
   * A copy of one block of a system's matrix (displacements or pressures by
   * displacements or pressures) for preconditioners: single precision, and one
   * column index for the n_rows x n_columns entries of a pair of nodes. At 2D
   * displacements that is 5 bytes an entry against Epetra's 12.
   */
  template <int n_rows, int n_columns>
  class NodeBlocks : public dealii::Subscriptor
  {
  public:
    NodeBlocks(const ColumnLayout                           &layout,
               const dealii::TrilinosWrappers::SparseMatrix &K,
               const Part                                    rows,
               const Part                                    columns);

    /// y = K x in the block's rows; the other rows of y become zero.
    void
    vmult(FloatVector &y, const FloatVector &x) const;

    /// y += factor K x in the block's rows; x with ghosts.
    void
    vmult_add(FloatVector &y, const float factor, const FloatVector &x) const;

    /// Calls action(row, column, value) for each entry; indices into vectors.
    template <typename Action>
    void
    for_each(const Action &action) const
    {
      for (unsigned int a = 0; a + 1 < start.size(); ++a)
        for (unsigned int k = start[a]; k < start[a + 1]; ++k)
          for (int i = 0; i < n_rows; ++i)
            for (int j = 0; j < n_columns; ++j)
              action(first_row + a * n_rows + i,
                     column[k] + j,
                     values[(std::size_t(k) * n_rows + i) * n_columns + j]);
    }

  private:
    unsigned int              first_row = 0;
    std::vector<unsigned int> start, column; ///< of node pairs
    std::vector<float>        values;
  };
} // namespace selkie
