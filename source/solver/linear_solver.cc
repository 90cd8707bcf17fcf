#include <selkie/base/exceptions.h>
#include <selkie/solver/linear_solver.h>
#include <selkie/solver/paced_control.h>
#include <selkie/solver/preconditioner.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_gmres.h>
#include <deal.II/lac/solver_minres.h>

#include <cmath>
#include <sstream>

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
        case SolverKind::cg_hats:
          return "CG with ML of the hat functions";
        case SolverKind::gmres_block:
          return "GMRES with block triangular multigrid";
        case SolverKind::minres_jacobi:
          return "MINRES with Jacobi";
        case SolverKind::direct:
          return "direct solver";
      }
    return "";
  }

  namespace
  {
    /// Whether it can do without a matrix (of LME functions).
    bool
    works_at_points(const SolverKind kind)
    {
      return kind == SolverKind::cg_hats || kind == SolverKind::cg_jacobi ||
             kind == SolverKind::gmres_block;
    }

    /// Whether its preconditioner is made of System::hats().
    bool
    uses_hats(const SolverKind kind, const SystemTraits &traits)
    {
      return kind == SolverKind::cg_hats ||
             (kind == SolverKind::gmres_block && traits.lme);
    }
  } // namespace

  template <int dim>
  LinearSolver<dim>::LinearSolver(const LinearSolverParameters &parameters,
                                  std::function<void(const std::string &)> log)
    : parameters(parameters)
    , log(std::move(log))
  {}

  template <int dim>
  SolverChoice
  LinearSolver<dim>::choose(const System<dim>  &system,
                            const SystemTraits &traits) const
  {
    SolverChoice choice = choose_kind(system, traits);
    if (traits.lme && works_at_points(choice.kind))
      {
        // Waves of a consistent mass take twice the iterations, and in 2D a
        // matrix is assembled in a dozen.
        const bool many_products =
          dim == 2 && traits.mixed && traits.consistent_mass;
        choice.matrix = !traits.at_points || many_products;
        choice.reason +=
          !traits.at_points
            ? "; with a matrix: not all terms are of points alone"
          : many_products
            ? "; with a matrix: a consistent mass takes many products"
            : "; without a matrix";
      }
    return choice;
  }

  template <int dim>
  SolverChoice
  LinearSolver<dim>::choose_kind(const System<dim>  &system,
                                 const SystemTraits &traits) const
  {
    if (parameters.kind != SolverKind::automatic)
      return {parameters.kind, "the scene says so"};
    if (system.n_global() < parameters.direct_below)
      return {SolverKind::direct,
              "fewer than " + std::to_string(parameters.direct_below) +
                " unknowns"};
    if (traits.mixed)
      return {SolverKind::gmres_block, "mixed"};
    if (traits.acoustic_cfl < 10.)
      return {SolverKind::cg_jacobi, "symmetric, acoustic CFL below 10"};
    return {traits.lme ? SolverKind::cg_hats : SolverKind::cg_ml,
            "symmetric, acoustic CFL of 10 or more"};
  }

  template <int dim>
  TangentParts
  LinearSolver<dim>::wants(const System<dim>  &system,
                           const SystemTraits &traits) const
  {
    if (gave_up)
      return {};
    const SolverChoice choice = choose(system, traits);
    return {choice.matrix,
            uses_hats(choice.kind, traits) && !keeps_multigrid(system)};
  }

  template <int dim>
  void
  LinearSolver<dim>::forget()
  {
    multigrid = Multigrid();
    gave_up   = false;
  }

  namespace
  {
    template <int dim>
    std::unique_ptr<const Preconditioner>
    make_preconditioner(const SolverKind    kind,
                        const System<dim>  &system,
                        const SystemTraits &traits)
    {
      switch (kind)
        {
          case SolverKind::cg_jacobi:
            return make_node_block_jacobi(system);
          case SolverKind::cg_ml:
            return make_ml(system);
          case SolverKind::cg_hats:
            return make_hats(system);
          case SolverKind::gmres_block:
            if (!traits.mixed)
              return traits.lme ? make_hats(system) : make_ml(system);
            return make_block_triangular(system);
          default:
            return make_jacobi(system);
        }
    }
  } // namespace

  template <int dim>
  LinearSolveReport
  LinearSolver<dim>::solve(const LinearProblem<dim> &problem, Vector &x)
  {
    return solve_first_by(choose(problem.system, problem.traits).kind,
                          problem,
                          x);
  }

  template <int dim>
  LinearSolveReport
  LinearSolver<dim>::solve_first_by(const SolverKind          kind,
                                    const LinearProblem<dim> &problem,
                                    Vector                   &x)
  {
    if (kind == SolverKind::direct)
      return solve_by(kind, problem, x);
    if (!gave_up)
      try
        {
          return solve_by(kind, problem, x);
        }
      catch (const LinearSolverFailure &failure)
        {
          gave_up = true;
          log(failure.what() +
              std::string("; the direct solver takes over for this step"));
        }
    auto report      = solve_by(SolverKind::direct, problem, x);
    report.fell_back = true;
    return report;
  }

  template <int dim>
  LinearSolveReport
  LinearSolver<dim>::solve_by(const SolverKind          kind,
                              const LinearProblem<dim> &problem,
                              Vector                   &x)
  {
    const System<dim>  &system = problem.system;
    const SystemTraits &traits = problem.traits;
    if (system.points() && !works_at_points(kind))
      problem.assemble({true, uses_hats(kind, traits)});
    switch (kind)
      {
        case SolverKind::cg_ml:
        case SolverKind::cg_hats:
        case SolverKind::gmres_block:
          return solve_with_multigrid(kind, problem, x);
        case SolverKind::direct:
          direct.factorise(system.shared_matrix(),
                           traits.symmetric && !traits.mixed);
          return refine(
            kind,
            [this](Vector &correction, const Vector &residual, const double) {
              direct.vmult(correction, residual);
              return 0u;
            },
            problem,
            x);
        default:
          return refine(kind,
                        krylov(kind,
                               *make_preconditioner(kind, system, traits),
                               parameters.max_iterations,
                               system),
                        problem,
                        x);
      }
  }

  /// Setting multigrid up costs as much as some iterations: that of an earlier
  /// matrix of the step serves until it needs clearly more of them than it did
  /// at first. (Iterations are counted by digit: tolerances differ.)
  template <int dim>
  bool
  LinearSolver<dim>::keeps_multigrid(const System<dim> &system) const
  {
    return multigrid.preconditioner != nullptr &&
           multigrid.unknowns == system.partitioner() &&
           multigrid.last <= 1.25 * multigrid.first + 0.4;
  }

  template <int dim>
  LinearSolveReport
  LinearSolver<dim>::solve_with_multigrid(const SolverKind          kind,
                                          const LinearProblem<dim> &problem,
                                          Vector                   &x)
  {
    const System<dim> &system = problem.system;
    const double       digits = std::max(1., -std::log10(problem.tolerance));
    const auto         run    = [&](const unsigned int max_iterations) {
      const auto report =
        refine(kind,
               krylov(kind, *multigrid.preconditioner, max_iterations, system),
               problem,
               x);
      multigrid.last = report.iterations / digits;
      return report;
    };
    if (keeps_multigrid(system))
      try
        {
          return run((2. * multigrid.first + 1.) * digits + 2.);
        }
      catch (const LinearSolverFailure &)
        {
          // A new one may do better.
          if (uses_hats(kind, problem.traits) && !system.hats())
            problem.assemble({!system.points(), true});
        }
    multigrid.preconditioner =
      make_preconditioner(kind, system, problem.traits);
    multigrid.unknowns = system.partitioner();
    const auto report  = run(parameters.max_iterations);
    multigrid.first    = multigrid.last;
    return report;
  }

  /// Corrects x, from zero, until its true residual is small: the iterative
  /// solvers see only an estimate of it, MINRES one in the preconditioner's
  /// norm, and factors are exact up to the growth of round-off.
  template <int dim>
  LinearSolveReport
  LinearSolver<dim>::refine(const SolverKind          kind,
                            const Correction         &correct,
                            const LinearProblem<dim> &problem,
                            Vector                   &x) const
  {
    const Vector          &rhs             = problem.rhs;
    const double           tolerance       = problem.tolerance;
    constexpr unsigned int max_corrections = 4;
    LinearSolveReport      report;
    report.solver     = to_string(kind);
    x                 = 0.;
    const double size = rhs.l2_norm();
    if (size == 0.)
      return report;

    Vector residual(rhs), correction(rhs);
    report.residual     = 1.;
    double       before = 0.;
    unsigned int n      = 0;
    do
      {
        before = report.residual;
        report.iterations +=
          correct(correction, residual, tolerance / report.residual);
        x += correction;
        problem.system.vmult(residual, x);
        residual.sadd(-1., 1., rhs);
        report.residual = residual.l2_norm() / size;
        if (!std::isfinite(report.residual))
          throw LinearSolverFailure(report.solver +
                                    ": the residual is not finite");
        if (report.residual <= tolerance)
          return report;
    } while (++n < max_corrections && report.residual < before);
    std::ostringstream text;
    text.precision(2);
    text << report.solver << ": the true residual is " << report.residual
         << " of the right-hand side after " << n
         << (n == 1 ? " correction" : " corrections")
         << ", above the tolerance of " << tolerance;
    throw LinearSolverFailure(text.str());
  }

  /// Corrections by a Krylov solver. @p preconditioner must outlive it.
  template <int dim>
  typename LinearSolver<dim>::Correction
  LinearSolver<dim>::krylov(const SolverKind      kind,
                            const Preconditioner &preconditioner,
                            const unsigned int    max_iterations,
                            const System<dim>    &system) const
  {
    return [=, &preconditioner, &system](Vector       &correction,
                                         const Vector &residual,
                                         const double  reduction) {
      double norm = residual.l2_norm(), share = 0.5;
      if (kind == SolverKind::minres_jacobi) // stops in another norm
        {
          preconditioner.vmult(correction, residual);
          norm  = std::sqrt(std::abs(correction * residual));
          share = 0.3;
        }
      const double   tolerance = std::max(share * reduction, 1e-14) * norm;
      SolverControl  plain(max_iterations, tolerance);
      PacedControl   paced(max_iterations, tolerance);
      SolverControl &control = kind == SolverKind::gmres_block ? paced : plain;
      correction             = 0.;
      const auto run         = [&](auto &&solver) {
        try
          {
            solver.solve(system, correction, residual, preconditioner);
          }
        catch (const SolverControl::NoConvergence &failure)
          {
            throw LinearSolverFailure(
              to_string(kind) + ": no convergence in " +
              std::to_string(std::min(failure.last_step, max_iterations)) +
              " iterations");
          }
        catch (const dealii::ExceptionBase &error)
          {
            throw LinearSolverFailure(to_string(kind) + ": breakdown (" +
                                      error.get_exc_name() + ")");
          }
      };
      if (kind == SolverKind::minres_jacobi)
        run(SolverMinRes<Vector>(control));
      else if (kind == SolverKind::gmres_block)
        run(SolverGMRES<Vector>(
          control, typename SolverGMRES<Vector>::AdditionalData(62, true)));
      else
        run(SolverCG<Vector>(control));
      return control.last_step();
    };
  }

  template class LinearSolver<2>;
  template class LinearSolver<3>;
} // namespace selkie
