#include <selkie/base/exceptions.h>
#include <selkie/solver/direct_solver.h>

#include <Amesos_Klu.h>
#include <Amesos_Mumps.h>
#include <Epetra_CrsMatrix.h>
#include <Epetra_LinearProblem.h>
#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>

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
            const int                                  room,
            const int most_unknowns_on_one_rank)
      : matrix(K)
      , symmetric(symmetric)
      , room(room)
    {
      const Epetra_CrsMatrix &epetra = K->epetra();
      problem.SetOperator(const_cast<Epetra_CrsMatrix *>(&epetra));
      if (epetra.Comm().NumProc() > 1 &&
          epetra.NumGlobalRows() <= most_unknowns_on_one_rank)
        {
          solver   = std::make_unique<Amesos_Klu>(problem);
          klu_says = solver->SymbolicFactorization();
          return;
        }
      auto with_mumps = std::make_unique<Amesos_Mumps>(problem);
      mumps           = with_mumps.get();
      solver          = std::move(with_mumps);
      Teuchos::ParameterList list;
      list.set("OutputLevel", 0);
      list.set("MatrixProperty", symmetric ? "symmetric" : "general");
      mumps->SetParameters(list);
      constexpr int relaxation_of_room = 14; // ICNTL(14)
      mumps->SetICNTL(relaxation_of_room, room);
      mumps->SymbolicFactorization();
    }

    /// @return the solver's error (MUMPS's INFOG(1)), negative on failure;
    /// alike on all ranks.
    int
    factorise()
    {
      if (error() >= 0)
        klu_says = solver->NumericFactorization();
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
      klu_says = solver->Solve();
      problem.SetLHS(nullptr);
      problem.SetRHS(nullptr);
      return error();
    }

    const char *
    name() const
    {
      return mumps != nullptr ? "MUMPS" : "KLU";
    }

    bool
    too_little_room()
    {
      const int e = error();
      return mumps != nullptr &&
             (e == -8 || e == -9); // for integers, for reals
    }

    bool
    singular()
    {
      return error() ==
             (mumps != nullptr ? -10 : NumericallySingularMatrixError);
    }

    const std::shared_ptr<const SystemMatrix> matrix;

    const bool symmetric;
    const int  room;

  private:
    int
    error()
    {
      return mumps != nullptr ? mumps->GetINFOG()[0] : klu_says;
    }

    Epetra_LinearProblem               problem;
    std::unique_ptr<Amesos_BaseSolver> solver;
    Amesos_Mumps                      *mumps    = nullptr; ///< if it is that
    int                                klu_says = 0;
  };

  DirectSolver::DirectSolver(const int most_unknowns_on_one_rank)
    : most_unknowns_on_one_rank(most_unknowns_on_one_rank)
  {}

  DirectSolver::~DirectSolver() = default;

  void
  DirectSolver::factorise(const std::shared_ptr<const SystemMatrix> &K,
                          const bool                                 symmetric,
                          const int                                  room)
  {
    if (!factors || factors->matrix != K || factors->symmetric != symmetric)
      factors = std::make_unique<Factors>(K,
                                          symmetric,
                                          room,
                                          most_unknowns_on_one_rank);

    constexpr int most_room = 5000; // percent
    int           error     = factors->factorise();
    while (factors->too_little_room() && factors->room < most_room)
      {
        const int more = 2 * (100 + factors->room) - 100;
        factors        = std::make_unique<Factors>(K,
                                            symmetric,
                                            more,
                                            most_unknowns_on_one_rank);
        error          = factors->factorise();
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
