// A static neo-Hookean solid by Q1 elements, as one writes it with deal.II's
// FEValues: after the code gallery's "Quasi-Static Finite-Strain Compressible
// Elasticity" and step-44 (assembly with symmetric gradients, lower triangle
// only, distribute_local_to_global into a Trilinos matrix). It is what Selkie's
// `q4 fem` is timed against: doc/performance.md.
//
//   fevalues_loop cook N direct|amg    Cook's membrane, N x N elements (2^k)
//   fevalues_loop block N direct|amg   a clamped cube, sheared, N^3 elements
//
// Prints unknowns, Newton iterations, the displacement of the loaded end's
// middle, and CPU seconds of assembly and solution.
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/timer.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/trilinos_precondition.h>
#include <deal.II/lac/trilinos_solver.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>
#include <deal.II/lac/trilinos_vector.h>
#include <deal.II/numerics/vector_tools.h>
#include <deal.II/physics/elasticity/kinematics.h>
#include <deal.II/physics/elasticity/standard_tensors.h>

#include <iostream>

using namespace dealii;

namespace
{
  struct Material
  {
    Material(const double E, const double nu)
      : G(E / (2. * (1. + nu)))
      , Lambda(E * nu / ((1. + nu) * (1. - 2. * nu)))
    {}

    const double G, Lambda; // W = G/2 (tr b - 3) - G ln J + L/4 (J^2-1-2 ln J)

    template <int dim>
    SymmetricTensor<2, dim>
    tau(const SymmetricTensor<2, dim> &b, const double J) const
    {
      const auto &I = Physics::Elasticity::StandardTensors<dim>::I;
      return G * (b - I) + 0.5 * Lambda * (J * J - 1.) * I;
    }

    template <int dim>
    SymmetricTensor<4, dim>
    Jc(const double J) const
    {
      using Tensors = Physics::Elasticity::StandardTensors<dim>;
      return Lambda * J * J * Tensors::IxI +
             (2. * G - Lambda * (J * J - 1.)) * Tensors::S;
    }
  };

  template <int dim>
  class Solid
  {
  public:
    Solid(const std::string &problem, const unsigned int n, const bool direct)
      : cook(problem == "cook")
      , direct(direct)
      , material(cook ? 1.0985e6 : 1e6, 0.3)
      , load(cook ? 62500. : 2e4)
      , mesh(MPI_COMM_WORLD)
      , dofs(mesh)
      , element(FE_Q<dim>(1), dim)
    {
      if (cook)
        {
          GridGenerator::general_cell(mesh, cook_corners());
          mesh.refine_global(std::lround(std::log2(n)));
        }
      else
        GridGenerator::subdivided_hyper_cube(mesh, n);
      set_up();
    }

    void
    run()
    {
      for (unsigned int step = 1; step <= 10; ++step)
        {
          double first = 0.;
          for (unsigned int i = 0; i < 20; ++i)
            {
              assemble(0.1 * step * load);
              // The residual without the clamped rows, against the load's.
              if (i == 0)
                first = rhs.l2_norm();
              else if (rhs.l2_norm() <= 1e-9 * first)
                break;
              solve();
              ++newton_iterations;
            }
        }
      std::cout << "unknowns " << dofs.n_dofs() << ", Newton "
                << newton_iterations << ", linear " << linear_iterations
                << ", tip " << tip_displacement() << " m, assembly "
                << assembly.cpu_time() << " s, solution " << solution_time()
                << " s\nper Newton iteration and unknown: assembly "
                << per_unknown(assembly.cpu_time()) << " us, solution "
                << per_unknown(solution_time()) << " us, together "
                << per_unknown(assembly.cpu_time() + solution_time())
                << " us\n";
    }

  private:
    static std::vector<Point<dim>>
    cook_corners()
    {
      std::vector<Point<dim>> corners(4);
      const double x[4] = {0., .048, 0., .048}, y[4] = {0., .044, .044, .060};
      for (unsigned int v = 0; v < 4; ++v)
        {
          corners[v][0] = x[v];
          corners[v][1] = y[v];
        }
      return corners;
    }

    void
    set_up()
    {
      dofs.distribute_dofs(element);
      const auto owned = dofs.locally_owned_dofs();
      for (const auto &face : mesh.active_face_iterators())
        if (face->at_boundary())
          face->set_all_boundary_ids(std::abs(face->center()[0]) < 1e-10 ? 1
                                                                         : 0);
      VectorTools::interpolate_boundary_values(
        dofs, 1, Functions::ZeroFunction<dim>(dim), constraints);
      constraints.close();
      DynamicSparsityPattern pattern(owned);
      DoFTools::make_sparsity_pattern(dofs, pattern, constraints, false);
      K.reinit(owned, owned, pattern, MPI_COMM_WORLD);
      for (auto *vector : {&u, &du, &rhs})
        vector->reinit(owned, MPI_COMM_WORLD);
    }

    bool
    is_loaded(const typename DoFHandler<dim>::face_iterator &face) const
    {
      return face->at_boundary() &&
             std::abs(face->center()[0] - (cook ? 0.048 : 1.)) < 1e-10;
    }

    void
    assemble(const double traction)
    {
      assembly.start();
      K   = 0.;
      rhs = 0.;
      const QGauss<dim>                quadrature(2);
      const QGauss<dim - 1>            face_quadrature(2);
      FEValues<dim>                    values(element,
                           quadrature,
                           update_gradients | update_JxW_values);
      FEFaceValues<dim>                face_values(element,
                                    face_quadrature,
                                    update_values | update_JxW_values);
      const FEValuesExtractors::Vector displacement(0);

      const unsigned int                   n = element.n_dofs_per_cell();
      FullMatrix<double>                   cell_matrix(n, n);
      dealii::Vector<double>               cell_rhs(n);
      std::vector<types::global_dof_index> indices(n);
      std::vector<Tensor<2, dim>>          grad_u(quadrature.size());
      std::vector<Tensor<2, dim>>          grad_Nx(n);
      std::vector<SymmetricTensor<2, dim>> symm_grad_Nx(n);
      for (const auto &cell : dofs.active_cell_iterators())
        {
          cell_matrix = 0.;
          cell_rhs    = 0.;
          values.reinit(cell);
          values[displacement].get_function_gradients(u, grad_u);
          for (unsigned int q = 0; q < quadrature.size(); ++q)
            {
              const auto   F = Physics::Elasticity::Kinematics::F(grad_u[q]);
              const auto   F_inv = invert(F);
              const double J     = determinant(F);
              const auto   tau =
                material.tau(Physics::Elasticity::Kinematics::b(F), J);
              const auto   Jc  = material.template Jc<dim>(J);
              const double JxW = values.JxW(q);
              for (unsigned int k = 0; k < n; ++k)
                {
                  grad_Nx[k]      = values[displacement].gradient(k, q) * F_inv;
                  symm_grad_Nx[k] = symmetrize(grad_Nx[k]);
                }
              for (unsigned int i = 0; i < n; ++i)
                {
                  const unsigned int c =
                    element.system_to_component_index(i).first;
                  const auto symm_grad_Nx_i_x_Jc = symm_grad_Nx[i] * Jc;
                  const Tensor<1, dim> grad_i_x_tau =
                    grad_Nx[i][c] * Tensor<2, dim>(tau);
                  cell_rhs(i) -= symm_grad_Nx[i] * tau * JxW;
                  for (unsigned int j = 0; j <= i; ++j)
                    {
                      double k_ij = symm_grad_Nx_i_x_Jc * symm_grad_Nx[j];
                      if (element.system_to_component_index(j).first == c)
                        k_ij += grad_i_x_tau * grad_Nx[j][c];
                      cell_matrix(i, j) += k_ij * JxW;
                    }
                }
            }
          for (unsigned int i = 0; i < n; ++i)
            for (unsigned int j = i + 1; j < n; ++j)
              cell_matrix(i, j) = cell_matrix(j, i);

          for (const auto &face : cell->face_iterators())
            if (is_loaded(face))
              {
                face_values.reinit(cell, face);
                for (unsigned int q = 0; q < face_quadrature.size(); ++q)
                  for (unsigned int i = 0; i < n; ++i)
                    if (element.system_to_component_index(i).first == 1)
                      cell_rhs(i) += traction * face_values.shape_value(i, q) *
                                     face_values.JxW(q);
              }
          cell->get_dof_indices(indices);
          constraints.distribute_local_to_global(
            cell_matrix, cell_rhs, indices, K, rhs);
        }
      K.compress(VectorOperation::add);
      rhs.compress(VectorOperation::add);
      assembly.stop();
    }

    void
    solve()
    {
      solution.start();
      SolverControl control(2000, 1e-8 * rhs.l2_norm());
      du = 0.;
      if (direct)
        {
          TrilinosWrappers::SolverDirect::AdditionalData data(false,
                                                              "Amesos_Mumps");
          TrilinosWrappers::SolverDirect                 solver(control, data);
          solver.solve(K, du, rhs);
        }
      else
        {
          TrilinosWrappers::PreconditionAMG                 amg;
          TrilinosWrappers::PreconditionAMG::AdditionalData data;
          DoFTools::extract_constant_modes(dofs,
                                           ComponentMask(dim, true),
                                           data.constant_modes);
          data.elliptic              = true;
          data.higher_order_elements = false;
          data.smoother_sweeps       = 2;
          data.aggregation_threshold = 0.02;
          amg.initialize(K, data);
          SolverCG<TrilinosWrappers::MPI::Vector> solver(control);
          solver.solve(K, du, rhs, amg);
          linear_iterations += control.last_step();
        }
      constraints.distribute(du);
      u += du;
      solution.stop();
    }

    /// Of the middle of the loaded end, along the load (m).
    double
    tip_displacement() const
    {
      Point<dim> tip;
      tip[0] = cook ? 0.048 : 1.;
      for (unsigned int d = 1; d < dim; ++d)
        tip[d] = cook ? 0.052 : 0.5;
      Vector<double> value(dim);
      VectorTools::point_value(dofs, u, tip, value);
      return value[1];
    }

    double
    solution_time() const
    {
      return solution.cpu_time();
    }

    double
    per_unknown(const double seconds) const
    {
      return 1e6 * seconds / newton_iterations / dofs.n_dofs();
    }

    const bool     cook, direct;
    const Material material;
    const double   load;

    parallel::distributed::Triangulation<dim> mesh;
    DoFHandler<dim>                           dofs;
    const FESystem<dim>                       element;
    AffineConstraints<double>                 constraints;
    TrilinosWrappers::SparseMatrix            K;
    TrilinosWrappers::MPI::Vector             u, du, rhs;

    mutable Timer assembly, solution;
    unsigned int  newton_iterations = 0, linear_iterations = 0;
  };
} // namespace

int
main(int argc, char **argv)
{
  const Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  if (argc != 4)
    {
      std::cerr << "fevalues_loop cook|block N direct|amg\n";
      return 1;
    }
  const std::string  problem = argv[1];
  const unsigned int n       = std::stoi(argv[2]);
  const bool         direct  = std::string(argv[3]) == "direct";
  if (problem == "cook")
    Solid<2>(problem, n, direct).run();
  else
    Solid<3>(problem, n, direct).run();
}
