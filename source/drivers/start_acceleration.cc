#include <selkie/base/exceptions.h>
#include <selkie/drivers/start_acceleration.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// M a = -residual, M being the consistent mass.
    template <int dim>
    void
    solve_consistent_mass(const typename Assembler<dim>::Terms &terms,
                          const SupportTable<dim>              &table,
                          const StepTime                       &time,
                          StepFields                           &fields,
                          const Vector                         &residual,
                          const double                          tolerance,
                          System<dim>                          &unknowns,
                          LinearSolver<dim>                    &solver,
                          Vector                               &a)
    {
      const unsigned int n_u = unknowns.n_owned_displacements();
      // The tangent of the inertia alone is alpha1 M; pressures have no mass.
      typename Assembler<dim>::Terms inertia;
      for (const auto &term : terms)
        if (term->use().acceleration)
          inertia.push_back(term);
      Vector rhs(residual);
      unknowns.want_matrix(table);
      Assembler<dim>(inertia, unknowns)
        .assemble(table, time, fields, 1., true, rhs);
      rhs = 0.;
      for (unsigned int i = 0; i < n_u; ++i)
        if (!unknowns.held(i))
          rhs.local_element(i) =
            -time.newmark.alpha1 * residual.local_element(i);
      for (unsigned int i = n_u; i < unknowns.n_owned(); ++i)
        unknowns.matrix().add(i, i, 1.);
      const SystemTraits of_mass;
      solver.solve_first_by(SolverKind::minres_jacobi,
                            {unknowns, of_mass, rhs, tolerance},
                            a);
    }

    /// The same with the lumped mass.
    template <int dim>
    void
    divide_by_mass(const System<dim> &unknowns,
                   const StepFields  &fields,
                   const Vector      &residual,
                   Vector            &a)
    {
      a = 0.;
      for (unsigned int i = 0; i < unknowns.n_owned_displacements(); ++i)
        if (!unknowns.held(i))
          a.local_element(i) =
            -residual.local_element(i) / fields.mass.local_element(i);
    }
  } // namespace


  template <int dim>
  Vector
  start_acceleration(const Scene<dim>                               &scene,
                     const typename Assembler<dim>::Terms           &terms,
                     const SupportTable<dim>                        &table,
                     const StepTime                                 &time,
                     StepFields                                     &fields,
                     const Vector                                   &residual,
                     System<dim>                                    &unknowns,
                     LinearSolver<dim>                              &solver,
                     const std::function<void(const std::string &)> &log)
  {
    Vector a;
    unknowns.initialize(a);
    bool lumped = scene.inertia->mass == MassKind::lumped;
    if (!lumped)
      try
        {
          solve_consistent_mass<dim>(terms,
                                     table,
                                     time,
                                     fields,
                                     residual,
                                     scene.linear_solver.tolerance,
                                     unknowns,
                                     solver,
                                     a);
        }
      catch (const LinearSolverFailure &failure)
        {
          log("Consistent mass: " + std::string(failure.what()) +
              "; the acceleration at the start is that of the lumped mass");
          lumped = true;
        }
    if (lumped)
      divide_by_mass(unknowns, fields, residual, a);
    a.update_ghost_values();
    return a;
  }


#define INSTANTIATE(dim)                    \
  template Vector start_acceleration(       \
    const Scene<dim> &,                     \
    const typename Assembler<dim>::Terms &, \
    const SupportTable<dim> &,              \
    const StepTime &,                       \
    StepFields &,                           \
    const Vector &,                         \
    System<dim> &,                          \
    LinearSolver<dim> &,                    \
    const std::function<void(const std::string &)> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
