#pragma once

#include <selkie/base/types.h>

#include <memory>

class Epetra_CrsMatrix;

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

    /// Solves K x = rhs.
    /// @param pattern a number that changes with the pattern of K
    /// @param symmetric only the lower triangle of K is read
    /// @throw LinearSolverFailure, on all ranks
    void
    solve(const Epetra_CrsMatrix &K,
          const unsigned int      pattern,
          const bool              symmetric,
          const Vector           &rhs,
          Vector                 &x);

  private:
    struct Analysis;
    std::unique_ptr<Analysis> analysis; ///< of the last pattern
  };
} // namespace selkie
