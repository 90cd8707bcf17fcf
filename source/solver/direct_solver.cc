#include <selkie/base/exceptions.h>
#include <selkie/solver/direct_solver.h>

#include <Amesos.h>
#include <Epetra_FECrsMatrix.h>
#include <Epetra_LinearProblem.h>
#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>

#include <cmath>

namespace selkie
{
  struct DirectSolver::Analysis
  {
    Analysis(const Matrix &K, const bool symmetric)
      : K(K)
      , symmetric(symmetric)
    {
      problem.SetOperator(
        const_cast<Epetra_FECrsMatrix *>(&K->trilinos_matrix()));
      solver.reset(Amesos().Create("Amesos_Mumps", problem));
      Teuchos::ParameterList list;
      list.set("MatrixProperty", symmetric ? "symmetric" : "general");
      solver->SetParameters(list);
      failed = solver->SymbolicFactorization() != 0;
    }

    const Matrix                       K; ///< Amesos needs it to the end
    const bool                         symmetric;
    bool                               failed;
    Epetra_LinearProblem               problem;
    std::unique_ptr<Amesos_BaseSolver> solver;
  };

  DirectSolver::DirectSolver() = default;

  DirectSolver::~DirectSolver() = default;

  void
  DirectSolver::solve(const Matrix &K,
                      const bool    symmetric,
                      const Vector &rhs,
                      Vector       &x)
  {
    if (!analysis || analysis->K != K || analysis->symmetric != symmetric)
      analysis = std::make_unique<Analysis>(K, symmetric);

    const auto   &matrix = K->trilinos_matrix();
    Epetra_Vector b(View, matrix.RangeMap(), const_cast<double *>(rhs.begin()));
    Epetra_Vector solution(View, matrix.DomainMap(), x.begin());
    analysis->problem.SetLHS(&solution);
    analysis->problem.SetRHS(&b);
    if (analysis->failed || analysis->solver->NumericFactorization() != 0 ||
        analysis->solver->Solve() != 0)
      {
        analysis.reset();
        throw LinearSolverFailure("the direct solver failed");
      }
    if (!std::isfinite(x.l2_norm()))
      throw LinearSolverFailure("the direct solver returned numbers that are "
                                "not finite: the system is singular");
  }
} // namespace selkie
