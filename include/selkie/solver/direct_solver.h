#pragma once

#include <selkie/assembly/system_matrix.h>

#include <memory>

namespace selkie
{
  /**
   * MUMPS; on several ranks KLU (through Amesos) for small systems, since MUMPS
   * does not give the same to the last digit there, run for run. What deal.II's
   * SolverDirect does not do:
   *
   * - What MUMPS found out about a sparsity pattern is kept as long as the
   *   pattern is the same, and of a symmetric matrix it factorises one half.
   * - MUMPS estimates the room for the factors before it pivots; how much it
   *   takes in truth depends, with several ranks, on which of them is busy. So
   *   the room is generous, and grows when it did not suffice.
   */
  class DirectSolver
  {
  public:
    /// On several ranks MUMPS adds up what they send as it arrives, so that no
    /// run is like the other; up to so many unknowns one rank does it alone.
    explicit DirectSolver(const int most_unknowns_on_one_rank = 1000);
    ~DirectSolver();

    /// Factorises. Collective. Another pattern is another matrix object; the
    /// last one is kept as long as its factors are, which refer to it.
    /// @param symmetric only the lower triangle of K may be read
    /// @param room in percent beyond MUMPS's own estimate
    /// @throw LinearSolverFailure, on all ranks, with the solver's error code.
    void
    factorise(const std::shared_ptr<const SystemMatrix> &K,
              const bool                                 symmetric,
              const int                                  room = 50);

    /// x = K^{-1} b as well as the factors know it. Collective.
    /// @throw LinearSolverFailure, on all ranks, with the solver's error code.
    void
    vmult(Vector &x, const Vector &b);

  private:
    class Factors;
    const int                most_unknowns_on_one_rank;
    std::unique_ptr<Factors> factors; ///< with the analysis of their pattern
  };
} // namespace selkie
