#pragma once

#include <Epetra_CrsMatrix.h>
#include <Epetra_Import.h>
#include <Epetra_Map.h>
#include <dmumps_c.h>

#include <vector>

namespace selkie
{
  /**
   * MUMPS, called directly: Amesos 13.2 hands every matrix over as an
   * unsymmetric one, whatever its MatrixProperty. Of a symmetric one MUMPS gets
   * the lower triangle, and makes L D L^T of it.
   *
   * What its functions return is MUMPS's INFOG(1), alike on all ranks: negative
   * is an error, above zero a warning. All are collective.
   */
  class Mumps
  {
  public:
    /// Analyses the matrix's pattern. The matrix must outlive it.
    Mumps(const Epetra_CrsMatrix &K, const bool symmetric);
    ~Mumps();
    Mumps(const Mumps &) = delete;
    Mumps &
    operator=(const Mumps &) = delete;

    /// Factorises the matrix's present values.
    /// @param room for the factors, in percent beyond MUMPS's own estimate
    int
    factorise(const int room);

    /// K x = b, of the owned rows.
    int
    solve(double *x, const double *b);

  private:
    int
    run(const int job);

    const Epetra_CrsMatrix &K;
    const Epetra_Map        on_first_rank;
    const Epetra_Import     to_first_rank;
    std::vector<int>        rows, columns; ///< of the entries, from 1 on
    std::vector<int>        places;        ///< among the matrix's values
    std::vector<double>     values;
    DMUMPS_STRUC_C          mumps;
  };
} // namespace selkie
