#include <selkie/base/exceptions.h>
#include <selkie/solver/direct_solver.h>
#include <selkie/solver/mumps.h>

#include <Amesos_Klu.h>
#include <Epetra_CrsMatrix.h>
#include <Epetra_LinearProblem.h>
#include <Epetra_Vector.h>

#include <algorithm>
#include <string>
#include <utility>

namespace selkie
{
  using namespace dealii;

  /// MUMPS, or KLU on one rank for all, with the problem that it refers to.
  class DirectSolver::Factors
  {
  public:
    Factors(const std::shared_ptr<const SystemMatrix> &K,
            const bool                                 symmetric,
            const int most_unknowns_on_one_rank)
      : matrix(K)
      , symmetric(symmetric)
    {
      const Epetra_CrsMatrix &epetra = K->epetra();
      if (epetra.Comm().NumProc() == 1 ||
          epetra.NumGlobalRows() > most_unknowns_on_one_rank)
        {
          mumps = std::make_unique<Mumps>(epetra, symmetric);
          return;
        }
      problem.SetOperator(const_cast<Epetra_CrsMatrix *>(&epetra));
      klu = std::make_unique<Amesos_Klu>(problem);
      klu->SymbolicFactorization();
    }

    /// @return the solver's error, negative on failure; alike on all ranks.
    int
    factorise(const int room)
    {
      error = mumps ? mumps->factorise(room) : klu->NumericFactorization();
      return error;
    }

    int
    solve(Vector &x, const Vector &b)
    {
      if (mumps)
        return mumps->solve(x.begin(), b.begin());
      const auto view = [](const Epetra_Map &map, const Vector &vector) {
        return Epetra_Vector(View, map, const_cast<double *>(vector.begin()));
      };
      const auto &K        = matrix->epetra();
      auto        solution = view(K.OperatorDomainMap(), x);
      auto        rhs      = view(K.OperatorRangeMap(), b);
      problem.SetLHS(&solution);
      problem.SetRHS(&rhs);
      const int result = klu->Solve();
      problem.SetLHS(nullptr);
      problem.SetRHS(nullptr);
      return result;
    }

    const char *
    name() const
    {
      return mumps ? "MUMPS" : "KLU";
    }

    bool
    too_little_room() const
    {
      return mumps && (error == -8 || error == -9); // for integers, for reals
    }

    bool
    singular() const
    {
      return error == (mumps ? -10 : NumericallySingularMatrixError);
    }

    const std::shared_ptr<const SystemMatrix> matrix;
    const bool                                symmetric;
    int                                       room = 0; ///< that sufficed

  private:
    std::unique_ptr<Mumps>      mumps;
    Epetra_LinearProblem        problem; ///< KLU's
    std::unique_ptr<Amesos_Klu> klu;
    int                         error = 0; ///< of the last factorisation
  };

  DirectSolver::DirectSolver(const int most_unknowns_on_one_rank)
    : most_unknowns_on_one_rank(most_unknowns_on_one_rank)
  {}

  DirectSolver::~DirectSolver() = default;

  void
  DirectSolver::factorise(const std::shared_ptr<const SystemMatrix> &K,
                          const bool                                 symmetric,
                          const int                                  first_room)
  {
    if (!factors || factors->matrix != K || factors->symmetric != symmetric)
      factors =
        std::make_unique<Factors>(K, symmetric, most_unknowns_on_one_rank);

    constexpr int most_room = 5000; // percent
    int          &room      = factors->room;
    room                    = std::max(room, first_room);
    int error               = factors->factorise(room);
    while (factors->too_little_room() && room < most_room)
      {
        room  = 2 * (100 + room) - 100;
        error = factors->factorise(room);
      }
    if (error >= 0) // above zero: a warning
      return;
    const std::string what = std::string(factors->name()) +
                             " cannot factorise the matrix (its error " +
                             std::to_string(error) +
                             (factors->singular() ? ": it is singular)" : ")");
    factors.reset();
    throw LinearSolverFailure(what);
  }

  void
  DirectSolver::vmult(Vector &x, const Vector &b)
  {
    const int error = factors->solve(x, b);
    if (error < 0)
      throw LinearSolverFailure(std::string(factors->name()) +
                                " cannot solve with its factors (its error " +
                                std::to_string(error) + ")");
  }
} // namespace selkie
