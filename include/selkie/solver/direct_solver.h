#pragma once

#include <selkie/base/types.h>

#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <memory>

namespace selkie
{
  /**
   * MUMPS, through Amesos. What it found out about a sparsity pattern is kept
   * as long as the pattern is the same; of a symmetric matrix it factorises one
   * half. deal.II's SolverDirect does neither.
   */
  class DirectSolver
  {
  public:
    DirectSolver();
    ~DirectSolver();

    using Matrix =
      std::shared_ptr<const dealii::TrilinosWrappers::SparseMatrix>;

    /// Solves K x = rhs.
    /// @param K another object whenever the pattern is another
    /// @param symmetric only the lower triangle of K is read
    /// @throw LinearSolverFailure, on all ranks
    void
    solve(const Matrix &K, const bool symmetric, const Vector &rhs, Vector &x);

  private:
    struct Analysis;
    std::unique_ptr<Analysis> analysis; ///< of the last pattern
  };
} // namespace selkie
