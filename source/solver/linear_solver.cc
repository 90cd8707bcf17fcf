#include <selkie/base/exceptions.h>
#include <selkie/solver/linear_solver.h>
#include <selkie/solver/preconditioner.h>

#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_gmres.h>
#include <deal.II/lac/solver_minres.h>

#include <cmath>

namespace selkie
{
  using namespace dealii;

  std::string
  to_string(const SolverKind kind)
  {
    switch (kind)
      {
        case SolverKind::automatic:
          return "automatic";
        case SolverKind::cg_jacobi:
          return "CG with node-block Jacobi";
        case SolverKind::cg_ml:
          return "CG with ML";
        case SolverKind::gmres_block:
          return "GMRES with block LDL^T";
        case SolverKind::minres_jacobi:
          return "MINRES with Jacobi";
        case SolverKind::direct:
          return "direct (MUMPS)";
      }
    return "";
  }

  template <int dim>
  LinearSolver<dim>::LinearSolver(const LinearSolverParameters &parameters,
                                  std::function<void(const std::string &)> log)
    : parameters(parameters)
    , log(std::move(log))
  {}

  template <int dim>
  SolverKind
  LinearSolver<dim>::choose(const System<dim>  &system,
                            const SystemTraits &traits) const
  {
    if (parameters.kind != SolverKind::automatic)
      return parameters.kind;
    const auto n = system.n_global();
    if (!traits.mixed)
      return n < 200                     ? SolverKind::direct
             : traits.acoustic_cfl < 10. ? SolverKind::cg_jacobi
                                         : SolverKind::cg_ml;
    // Mixed systems need hundreds of MINRES iterations once water splashes:
    // up to this size a factorisation is cheaper. In 3D it fills in more.
    if (n < parameters.direct_below / (dim == 2 ? 1 : 4))
      return SolverKind::direct;
    const bool soft = !traits.has_solid || traits.acoustic_cfl < 20.;
    return traits.symmetric && soft ? SolverKind::minres_jacobi
                                    : SolverKind::gmres_block;
  }

  namespace
  {
    template <int dim>
    std::unique_ptr<const Preconditioner>
    make_preconditioner(const SolverKind    kind,
                        const System<dim>  &system,
                        const SystemTraits &traits)
    {
      const auto &matrix = *system.shared_matrix();
      switch (kind)
        {
          case SolverKind::cg_jacobi:
            return make_node_block_jacobi(system, matrix);
          case SolverKind::cg_ml:
            return make_ml(system, matrix);
          case SolverKind::gmres_block:
            return make_block_ldlt(system, matrix, traits.has_solid);
          default:
            return make_jacobi(matrix);
        }
    }

    /// |rhs - K x|, of which the iterative solvers see only an estimate.
    double
    true_residual(const TrilinosWrappers::SparseMatrix &matrix,
                  const Vector                         &rhs,
                  const Vector                         &x,
                  Vector                               &work)
    {
      matrix.vmult(work, x);
      work.sadd(-1., 1., rhs);
      return work.l2_norm();
    }
  } // namespace

  template <int dim>
  LinearSolveReport
  LinearSolver<dim>::solve(System<dim>        &system,
                           const SystemTraits &traits,
                           const Vector       &rhs,
                           Vector             &x)
  {
    LinearSolveReport report;
    const SolverKind  kind = choose(system, traits);
    report.solver          = to_string(kind);
    if (kind != SolverKind::direct)
      {
        std::string reason;
        try
          {
            report.iterations =
              kind == SolverKind::cg_ml
                ? iterate_with_multigrid(system, traits, rhs, x)
                : iterate(kind,
                          *make_preconditioner(kind, system, traits),
                          parameters.max_iterations,
                          system,
                          rhs,
                          x);
            return report;
          }
        catch (const SolverControl::NoConvergence &error)
          {
            reason = "no convergence in " + std::to_string(error.last_step) +
                     " iterations";
          }
        catch (const LinearSolverFailure &error)
          {
            reason = error.what();
          }
        report.fell_back = true;
        report.solver    = to_string(SolverKind::direct);
        log(to_string(kind) + ": " + reason + "; the direct solver takes over");
      }
    direct.solve(system.shared_matrix(),
                 traits.symmetric && !traits.mixed,
                 rhs,
                 x);
    return report;
  }

  /// Setting ML up costs as much as some ten iterations: that of an earlier
  /// matrix serves until it needs clearly more of them than it did at first.
  template <int dim>
  unsigned int
  LinearSolver<dim>::iterate_with_multigrid(System<dim>        &system,
                                            const SystemTraits &traits,
                                            const Vector       &rhs,
                                            Vector             &x)
  {
    const auto run = [&](const unsigned int max_iterations) {
      return iterate(SolverKind::cg_ml,
                     *multigrid.preconditioner,
                     max_iterations,
                     system,
                     rhs,
                     x);
    };
    if (multigrid.preconditioner != nullptr &&
        multigrid.matrix == system.shared_matrix() &&
        multigrid.acoustic_cfl == traits.acoustic_cfl &&
        multigrid.last <= multigrid.first + std::max(3u, multigrid.first / 4))
      try
        {
          multigrid.last = run(2 * multigrid.first + 10);
          return multigrid.last;
        }
      catch (const SolverControl::NoConvergence &)
        {} // a new one may do better
      catch (const LinearSolverFailure &)
        {}
    multigrid.preconditioner.reset();
    multigrid.matrix = system.shared_matrix();
    multigrid.preconditioner =
      make_preconditioner(SolverKind::cg_ml, system, traits);
    multigrid.acoustic_cfl = traits.acoustic_cfl;
    multigrid.first = multigrid.last = run(parameters.max_iterations);
    return multigrid.last;
  }

  template <int dim>
  unsigned int
  LinearSolver<dim>::iterate(const SolverKind      kind,
                             const Preconditioner &preconditioner,
                             const unsigned int    max_iterations,
                             const System<dim>    &system,
                             const Vector         &rhs,
                             Vector               &x)
  {
    const auto  &matrix     = *system.shared_matrix();
    const double target     = parameters.tolerance * rhs.l2_norm();
    unsigned int iterations = 0;
    Vector       residual(rhs), correction(rhs);
    x = 0.;
    if (target == 0.)
      return 0;
    residual = rhs;
    // MINRES stops in the preconditioner's norm: ask it again for what is
    // left until the true residual is small.
    for (unsigned int round = 0; round < 4; ++round)
      {
        const double  size = residual.l2_norm();
        SolverControl control(max_iterations,
                              std::max(0.5 * target, 1e-14 * size));
        correction = 0.;
        if (kind == SolverKind::minres_jacobi)
          {
            Vector scaled(residual);
            preconditioner.vmult(scaled, residual);
            const double         norm = std::sqrt(std::abs(scaled * residual));
            SolverControl        minres_control(max_iterations,
                                         0.3 * norm * target / size);
            SolverMinRes<Vector> solver(minres_control);
            solver.solve(matrix, correction, residual, preconditioner);
            iterations += minres_control.last_step();
          }
        else if (kind == SolverKind::gmres_block)
          {
            SolverGMRES<Vector>::AdditionalData data;
            data.max_n_tmp_vectors     = 62;
            data.right_preconditioning = true;
            SolverGMRES<Vector> solver(control, data);
            solver.solve(matrix, correction, residual, preconditioner);
            iterations += control.last_step();
          }
        else
          {
            SolverCG<Vector> solver(control);
            solver.solve(matrix, correction, residual, preconditioner);
            iterations += control.last_step();
          }
        x += correction;
        const double left = true_residual(matrix, rhs, x, residual);
        if (!std::isfinite(left))
          throw LinearSolverFailure("the residual is not finite");
        if (left <= 2. * target)
          return iterations;
      }
    throw LinearSolverFailure(
      "the true residual stays above the tolerance after " +
      std::to_string(iterations) + " iterations");
  }

  template class LinearSolver<2>;
  template class LinearSolver<3>;
} // namespace selkie
