#include <selkie/base/exceptions.h>
#include <selkie/solver/direct_solver.h>

#include <Amesos_Mumps.h>
#include <Epetra_CrsMatrix.h>
#include <Epetra_LinearProblem.h>
#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>

namespace selkie
{
  using namespace dealii;

  /// MUMPS with the problem that it refers to.
  class DirectSolver::Factors
  {
  public:
    Factors(const std::shared_ptr<const SystemMatrix> &K,
            const bool                                 symmetric,
            const int                                  room)
      : matrix(K)
      , symmetric(symmetric)
      , room(room)
      , mumps(problem)
    {
      problem.SetOperator(const_cast<Epetra_CrsMatrix *>(&K->epetra()));
      Teuchos::ParameterList list;
      list.set("OutputLevel", 0);
      list.set("MatrixProperty", symmetric ? "symmetric" : "general");
      mumps.SetParameters(list);
      constexpr int relaxation_of_room = 14; // ICNTL(14)
      mumps.SetICNTL(relaxation_of_room, room);
      mumps.SymbolicFactorization();
    }

    /// @return MUMPS's INFOG(1), negative on failure; alike on all ranks.
    int
    factorise()
    {
      if (error() >= 0)
        mumps.NumericFactorization();
      return error();
    }

    int
    solve(Vector &x, const Vector &b)
    {
      const auto view = [](const Epetra_Map &map, const Vector &vector) {
        return Epetra_Vector(View, map, const_cast<double *>(vector.begin()));
      };
      const auto &K        = matrix->epetra();
      auto        solution = view(K.OperatorDomainMap(), x);
      auto        rhs      = view(K.OperatorRangeMap(), b);
      problem.SetLHS(&solution);
      problem.SetRHS(&rhs);
      mumps.Solve();
      problem.SetLHS(nullptr);
      problem.SetRHS(nullptr);
      return error();
    }

    const std::shared_ptr<const SystemMatrix> matrix;

    const bool symmetric;
    const int  room;

  private:
    int
    error()
    {
      return mumps.GetINFOG()[0];
    }

    Epetra_LinearProblem problem;
    Amesos_Mumps         mumps;
  };

  DirectSolver::DirectSolver() = default;

  DirectSolver::~DirectSolver() = default;

  void
  DirectSolver::factorise(const std::shared_ptr<const SystemMatrix> &K,
                          const bool                                 symmetric,
                          const int                                  room)
  {
    if (!factors || factors->matrix != K || factors->symmetric != symmetric)
      factors = std::make_unique<Factors>(K, symmetric, room);

    const auto too_little_room = [](const int error) {
      return error == -8 || error == -9; // for integers, for reals
    };
    constexpr int most_room = 5000; // percent
    int           error     = factors->factorise();
    while (too_little_room(error) && factors->room < most_room)
      {
        const int more = 2 * (100 + factors->room) - 100;
        factors        = std::make_unique<Factors>(K, symmetric, more);
        error          = factors->factorise();
      }
    if (error >= 0) // above zero: a warning
      return;
    factors.reset();
    throw LinearSolverFailure("MUMPS cannot factorise the matrix (its error " +
                              std::to_string(error) +
                              (error == -10 ? ": it is singular)" : ")"));
  }

  void
  DirectSolver::vmult(Vector &x, const Vector &b)
  {
    const int error = factors->solve(x, b);
    if (error < 0)
      throw LinearSolverFailure("MUMPS cannot solve with its factors (its "
                                "error " +
                                std::to_string(error) + ")");
  }
} // namespace selkie
