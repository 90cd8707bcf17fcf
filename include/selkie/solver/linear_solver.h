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
    bool   lme          = false; ///< else hat functions themselves
    double acoustic_cfl = 0;     ///< largest c dt / h over the bodies
    bool   at_points    = true;  ///< PointTangent can be its tangent

    bool consistent_mass = false; ///< else lumped, or none
  };

  /// K x = rhs with System::points() or System::matrix().
  template <int dim>
  struct LinearProblem
  {
    const System<dim>  &system;
    const SystemTraits &traits;
    const Vector       &rhs;
    double              tolerance; ///< of the true residual, relative

    /// Assembles the same tangent anew with these parts, for solvers that need
    /// more of it. May be missing if there is a matrix and, where the solver
    /// wants them, hats. Collective.
    std::function<void(const TangentParts &)> assemble = {};
  };

  struct LinearSolveReport
  {
    unsigned int iterations = 0; ///< zero for the direct solver
    std::string  solver;         ///< the one that succeeded
    bool         fell_back = false;
    double       residual  = 0; ///< true one, relative to the right-hand side
  };

  /// A solver and why it was chosen.
  struct SolverChoice
  {
    SolverKind  kind;
    std::string reason;
    bool        matrix = true; ///< else it works with System::points()
  };

  /**
   * The linear solvers, after the measurements of solver.md and
   * doc/performance.md: conjugate gradients for solids, with node-block Jacobi
   * below acoustic CFL 10 and multigrid above (TwoLevel for LME, ML for hat
   * functions); GMRES with the block triangular preconditioner for mixed
   * systems; the direct solver for small ones. LME mostly has no matrix. On
   * breakdown, stagnation or NaN the direct solver takes over, and says so, and
   * a matrix is made for it if there was none. Every result, the direct
   * one too, is judged by its true residual: |rhs - K x| <= tolerance |rhs|,
   * or it is refined until it is.
   */
  template <int dim>
  class LinearSolver
  {
  public:
    /// @param log takes one line for each fall-back.
    LinearSolver(const LinearSolverParameters            &parameters,
                 std::function<void(const std::string &)> log);

    /// What the next solve() of this system needs of the tangent. Hats are for
    /// a new preconditioner: as long as the last one serves, none are needed.
    TangentParts
    wants(const System<dim> &system, const SystemTraits &traits) const;

    /// Forgets what it has kept of earlier systems.
    void
    forget();

    /// Solves the problem by the solver that suits it, or by the direct one if
    /// that fails; the next ones, too, until forget(): what fails for one
    /// matrix of a step fails for the next. Throws LinearSolverFailure, with
    /// the residual reached, when the direct solver fails, too.
    LinearSolveReport
    solve(const LinearProblem<dim> &problem, Vector &x);

    /// The same, tried with this solver first.
    LinearSolveReport
    solve_first_by(const SolverKind          kind,
                   const LinearProblem<dim> &problem,
                   Vector                   &x);

    /// The same by one solver alone: LinearSolverFailure if it does not do.
    LinearSolveReport
    solve_by(const SolverKind          kind,
             const LinearProblem<dim> &problem,
             Vector                   &x);

    /// Which solver this system gets, and why.
    SolverChoice
    choose(const System<dim> &system, const SystemTraits &traits) const;

  private:
    /// Whether a preconditioner of an earlier matrix of the step serves.
    bool
    keeps_multigrid(const System<dim> &system) const;

    /// The choice but for the matrix.
    SolverChoice
    choose_kind(const System<dim> &system, const SystemTraits &traits) const;

    /// A correction of x that removes a residual up to `reduction` of it;
    /// returns the iterations it took.
    using Correction = std::function<unsigned int(Vector       &correction,
                                                  const Vector &residual,
                                                  const double  reduction)>;

    LinearSolveReport
    solve_with_multigrid(const SolverKind          kind,
                         const LinearProblem<dim> &problem,
                         Vector                   &x);
    LinearSolveReport
    refine(const SolverKind          kind,
           const Correction         &correct,
           const LinearProblem<dim> &problem,
           Vector                   &x) const;
    Correction
    krylov(const SolverKind      kind,
           const Preconditioner &preconditioner,
           const unsigned int    max_iterations,
           const System<dim>    &system) const;

    /// Of the present or an earlier matrix of the step.
    struct Multigrid
    {
      std::shared_ptr<const SystemMatrix::Partitioner> unknowns;
      std::unique_ptr<const Preconditioner>            preconditioner;

      double first = 0, last = 0; ///< iterations per digit
    };

    const LinearSolverParameters                   parameters;
    const std::function<void(const std::string &)> log;
    DirectSolver                                   direct;
    Multigrid                                      multigrid;
    bool                                           gave_up = false;
  };

  std::string
  to_string(const SolverKind kind);
} // namespace selkie
