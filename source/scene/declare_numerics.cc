#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>

#include <deal.II/base/patterns.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    using Patterns::Double;
    using Patterns::Integer;

    void
    declare_lme(ParameterHandler &prm, LmeParameters &lme)
    {
      prm.enter_subsection("LME");
      prm.add_parameter("Gamma",
                        lme.gamma,
                        "Locality of the functions, beta = gamma / h^2: small "
                        "is wide and quiet when points cross cells, large is "
                        "narrow and cheap. Units: none.",
                        Double(0.));
      prm.add_parameter("Support tolerance",
                        lme.support_tolerance,
                        "Nodes of a smaller weight exp(-beta r^2) are left "
                        "out: the support radius is h sqrt(-ln(tolerance) / "
                        "gamma). Units: none.",
                        Double(1e-16, 0.1));
      prm.add_parameter("Newton tolerance",
                        lme.newton_tolerance,
                        "At which |r| / h the iteration for lambda stops. "
                        "Units: none.",
                        Double(1e-15, 1e-3));
      prm.leave_subsection();
    }


    void
    declare_transfer(ParameterHandler &prm, Transfer &transfer)
    {
      prm.enter_subsection("Transfer");
      add_choice(prm,
                 "Scheme",
                 transfer.scheme,
                 {{"flip", TransferScheme::flip},
                  {"tpic", TransferScheme::tpic}},
                 "How velocities go from nodes to points: `flip` adds the "
                 "nodes' increments, `tpic` carries a velocity gradient. "
                 "Units: none.");
      prm.add_parameter("FLIP fraction",
                        transfer.flip_fraction,
                        "Share of FLIP in `flip`; the rest is PIC, which damps "
                        "noise. Units: none.",
                        Double(0., 1.));
      prm.add_parameter("FLIP interval",
                        transfer.flip_interval,
                        "Time in which FLIP fraction is mixed in: shorter "
                        "steps take less of PIC each. 0: every step takes all "
                        "of it, however short. Units: s.",
                        Double(0.));
      prm.add_parameter("Projection order",
                        transfer.order,
                        "Of the velocities that go from points to nodes. 1: "
                        "means of the points, which smooth motion over h / "
                        "sqrt(2 gamma). Each order more adds what the nodes "
                        "still miss of it, at the cost of a pass over the "
                        "points. Units: none.",
                        Integer(1, 10));
      prm.leave_subsection();
    }


    void
    declare_time(ParameterHandler &prm, TimeParameters &time)
    {
      prm.enter_subsection("Time");
      prm.add_parameter("End time",
                        time.end_time,
                        "The run starts at 0 and ends here. Units: s.",
                        Double(0.));
      prm.add_parameter("Step",
                        time.step,
                        "Time step, the largest; a failing step is cut. "
                        "Units: s.",
                        Double(0.));
      prm.add_parameter("Acoustic CFL",
                        time.acoustic_cfl,
                        "Largest c dt / h of the stiffest body; smaller steps "
                        "than Step are taken to keep it. 0: any. Units: none.",
                        Double(0.));
      prm.add_parameter("Largest error",
                        time.largest_error,
                        "Steps are made as small as keeps the estimated error "
                        "of each below this, rms over the matter, in cells. "
                        "0: any. Units: none.",
                        Double(0.));
      prm.add_parameter("Smallest step",
                        time.smallest_step,
                        "A run that needs a smaller one fails; 0 means Step / "
                        "1024. Units: s.",
                        Double(0.));
      prm.add_parameter("Easy steps",
                        time.easy_steps,
                        "After so many good steps a cut step grows again. "
                        "Units: none.",
                        Integer(1));
      prm.add_parameter("Largest move",
                        time.max_move,
                        "How far a point may move in a step, in cells; a step "
                        "that would move one farther is cut. Units: none.",
                        Double(0.01, 0.9));
      prm.add_parameter("Largest energy jump",
                        time.largest_energy_jump,
                        "How much energy a step may gain that no load and no "
                        "moving wall gives, of the energy in play in it: of "
                        "motion and stored, at its start or end, and what "
                        "gravity and loads give. A step that would gain more "
                        "is cut; to look costs two passes over the points. "
                        "0: any. Units: none.",
                        Double(0.));
      prm.add_parameter("Estimate errors",
                        time.estimate_error,
                        "Whether the run ends with an estimate of its errors: "
                        "that of each step from the change of the "
                        "acceleration, that of the mesh from the jumps of the "
                        "velocity's gradient in the last step. Units: none.");
      prm.leave_subsection();
    }


    void
    declare_newton(ParameterHandler &prm, NewtonParameters &newton)
    {
      prm.enter_subsection("Newton");
      prm.add_parameter("Tolerance",
                        newton.tolerance,
                        "Residual, relative to the largest of its parts, at "
                        "which the iteration stops. Units: none.",
                        Double(1e-15, 0.1));
      prm.add_parameter("Iterations",
                        newton.max_iterations,
                        "A step that needs more is cut. Units: none.",
                        Integer(1));
      prm.add_parameter("Line search",
                        newton.line_search,
                        "Whether an increment that does not reduce the "
                        "residual is shortened. Units: none.");
      prm.leave_subsection();
    }


    void
    declare_linear_solver(ParameterHandler &prm, LinearSolverParameters &solver)
    {
      prm.enter_subsection("Linear solver");
      add_choice(prm,
                 "Solver",
                 solver.kind,
                 {{"automatic", SolverKind::automatic},
                  {"cg jacobi", SolverKind::cg_jacobi},
                  {"cg ml", SolverKind::cg_ml},
                  {"cg hats", SolverKind::cg_hats},
                  {"gmres block", SolverKind::gmres_block},
                  {"minres jacobi", SolverKind::minres_jacobi},
                  {"direct", SolverKind::direct}},
                 "`automatic` chooses from symmetry, size and time step and "
                 "says so in the log. Units: none.");
      prm.add_parameter("Tolerance",
                        solver.tolerance,
                        "Of the true residual, relative to the right-hand "
                        "side. Units: none.",
                        Double(1e-15, 0.1));
      prm.add_parameter("Loosest tolerance",
                        solver.loosest,
                        "Newton's method asks for no better a solution than it "
                        "can use, between this and Tolerance. Units: none.",
                        Double(1e-15, 0.1));
      prm.add_parameter("Iterations",
                        solver.max_iterations,
                        "After so many, or earlier where more would not help, "
                        "the direct solver takes over. Units: none.",
                        Integer(1));
      prm.add_parameter("Direct below",
                        solver.direct_below,
                        "`automatic` solves systems with fewer unknowns "
                        "directly. Units: none.",
                        Integer(0));
      prm.leave_subsection();
    }
  } // namespace


  template <int dim>
  void
  declare_numerics(ParameterHandler &prm, Scene<dim> &scene)
  {
    declare_lme(prm, scene.lme);
    declare_transfer(prm, scene.transfer);
    declare_time(prm, scene.time);
    declare_newton(prm, scene.newton);
    declare_linear_solver(prm, scene.linear_solver);
  }


  template void
  declare_numerics(ParameterHandler &, Scene<2> &);
  template void
  declare_numerics(ParameterHandler &, Scene<3> &);
} // namespace selkie
