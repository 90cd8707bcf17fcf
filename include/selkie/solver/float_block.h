#pragma once

#include <selkie/assembly/system.h>

#include <deal.II/base/subscriptor.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <vector>

namespace selkie
{
  /// For preconditioners, in the layout of a matrix's columns: half the memory
  /// traffic.
  using FloatVector = dealii::LinearAlgebra::distributed::Vector<float>;

  /// A kind of unknowns.
  enum class Part
  {
    displacements,
    pressures
  };

  FloatVector
  float_vector(const SystemMatrix &matrix);

  /**
   * A copy of one block of a system's matrix (displacements or pressures by
   * displacements or pressures) for preconditioners, in single precision: with
   * next to no column indices, 4 bytes an entry against Epetra's 12.
   */
  class FloatBlock : public dealii::Subscriptor
  {
  public:
    template <int dim>
    FloatBlock(const System<dim> &system, const Part rows, const Part columns);

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
      const float *value = values.data();
      for (const Rows &rows : groups)
        for (unsigned int k = rows.begin; k < rows.end; ++k)
          for (unsigned int r = 0; r < rows.n; ++r)
            for (unsigned int j = 0; j < runs[k].length; ++j)
              action(rows.first + r, runs[k].column + j, *value++);
    }

  private:
    /// Rows with the same columns: runs [begin, end).
    struct Rows
    {
      unsigned int first, n, begin, end;
    };
    struct Run
    {
      unsigned int column, length;
    };

    std::vector<Rows>  groups;
    std::vector<Run>   runs;
    std::vector<float> values; ///< group by group, run by run, row by row
  };
} // namespace selkie
