#pragma once

#include <selkie/assembly/system.h>
#include <selkie/base/types.h>
#include <selkie/scene/scene.h>
#include <selkie/solver/direct_solver.h>
#include <selkie/solver/preconditioner.h>

#include <functional>
#include <string>

namespace selkie
{
  /// What the choice of a solver depends on.
  struct SystemTraits
  {
    bool   mixed        = false; ///< has pressures: quasi-definite
    bool   symmetric    = true;  ///< no (relevant) viscosity
    bool   has_solid    = false;
    double acoustic_cfl = 0; ///< largest c dt / h over the bodies
  };

  struct LinearSolveReport
  {
    unsigned int iterations = 0; ///< zero for the direct solver
    std::string  solver;         ///< the one that succeeded
    bool         fell_back = false;
  };

  /**
   * The linear solvers, after the measurements of solver.md: conjugate
   * gradients for solids, with node-block Jacobi below acoustic CFL 10 and ML
   * (rigid-body modes; set up anew only when it pays) above; for mixed systems
   * MINRES with Jacobi while they are symmetric, small and soft, else GMRES
   * with the block LDL^T preconditioner. Convergence is judged by the true
   * residual. On breakdown, stagnation or NaN the direct solver (MUMPS) takes
   * over, and says so.
   */
  template <int dim>
  class LinearSolver
  {
  public:
    /// @param log takes one line for each fall-back.
    LinearSolver(const LinearSolverParameters            &parameters,
                 std::function<void(const std::string &)> log);

    /// Solves K x = rhs with System::matrix(). Throws LinearSolverFailure when
    /// the direct solver fails, too.
    LinearSolveReport
    solve(System<dim>        &system,
          const SystemTraits &traits,
          const Vector       &rhs,
          Vector             &x);

    /// Which solver `automatic` means for this system, and why.
    SolverKind
    choose(const System<dim> &system, const SystemTraits &traits) const;

  private:
    unsigned int
    iterate_with_multigrid(System<dim>        &system,
                           const SystemTraits &traits,
                           const Vector       &rhs,
                           Vector             &x);
    unsigned int
    iterate(const SolverKind      kind,
            const Preconditioner &preconditioner,
            const unsigned int    max_iterations,
            const System<dim>    &system,
            const Vector         &rhs,
            Vector               &x);

    /// ML of the present or an earlier matrix of the same pattern.
    struct Multigrid
    {
      DirectSolver::Matrix                  matrix; ///< ML needs it to the end
      std::unique_ptr<const Preconditioner> preconditioner;
      double                                acoustic_cfl = 0;
      unsigned int                          first = 0, last = 0; ///< iterations
    };

    const LinearSolverParameters                   parameters;
    const std::function<void(const std::string &)> log;
    DirectSolver                                   direct;
    Multigrid                                      multigrid;
  };

  std::string
  to_string(const SolverKind kind);
} // namespace selkie
