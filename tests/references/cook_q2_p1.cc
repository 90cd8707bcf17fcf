// Cook's membrane, nearly incompressible, by another method: displacements
// Q2, pressures P1 discontinuous (inf-sup stable), Newton, UMFPACK. The law is
// `isochoric neo hookean`: W = G/2 (J^(-2/3) tr b - 3) + U(J),
// U = K/4 (J^2 - 1 - 2 ln J); p = U'(J) holds in the mean with all P1.
//
//   cook_q2_p1 NU N     N x N elements (a power of two), Poisson's ratio NU
//
// Prints the rise of the loaded edge's middle. Nothing of Selkie is in it.
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_dgp.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/sparse_direct.h>
#include <deal.II/lac/sparse_matrix.h>
#include <deal.II/numerics/vector_tools.h>
#include <deal.II/physics/elasticity/kinematics.h>
#include <deal.II/physics/elasticity/standard_tensors.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

using namespace dealii;

namespace
{
  constexpr unsigned int dim = 2;
  constexpr double       E   = 1.0985e6; // Pa, as in cook_membrane.prm

  class Cook
  {
  public:
    Cook(const double nu, const unsigned int n)
      : K(E / (3. * (1. - 2. * nu)))
      , G(E / (2. * (1. + nu)))
      , element(FE_Q<dim>(2), dim, FE_DGP<dim>(1), 1)
      , dofs(mesh)
    {
      GridGenerator::general_cell(
        mesh, {{0., 0.}, {.048, .044}, {0., .044}, {.048, .060}});
      mesh.refine_global(std::lround(std::log2(n)));
      for (const auto &face : mesh.active_face_iterators())
        if (face->at_boundary())
          face->set_boundary_id(face->center()[0] < 1e-10           ? 1
                                : face->center()[0] > 0.048 - 1e-10 ? 2
                                                                    : 0);
      dofs.distribute_dofs(element);
      VectorTools::interpolate_boundary_values(
        dofs,
        1,
        Functions::ZeroFunction<dim>(dim + 1),
        constraints,
        element.component_mask(displacement));
      constraints.close();
      DynamicSparsityPattern entries(dofs.n_dofs());
      DoFTools::make_sparsity_pattern(dofs, entries, constraints, false);
      pattern.copy_from(entries);
      matrix.reinit(pattern);
      for (auto *vector : {&solution, &step, &rhs})
        vector->reinit(dofs.n_dofs());
    }

    double
    rise()
    {
      for (unsigned int k = 1; k <= 10; ++k)
        {
          double first = 0.;
          for (unsigned int i = 0;; ++i)
            {
              assemble(6250. * k);
              if (i == 0)
                first = rhs.l2_norm();
              else if (rhs.l2_norm() < 1e-10 * first)
                break;
              if (i == 20)
                throw std::runtime_error("Newton does not converge");
              SparseDirectUMFPACK solver;
              solver.initialize(matrix);
              solver.vmult(step, rhs);
              constraints.distribute(step);
              solution += step;
            }
        }
      dealii::Vector<double> tip(dim + 1);
      VectorTools::point_value(dofs, solution, Point<dim>(.048, .052), tip);
      return tip[1];
    }

    unsigned int
    n_dofs() const
    {
      return dofs.n_dofs();
    }

  private:
    void
    assemble(const double traction)
    {
      using Tensors = Physics::Elasticity::StandardTensors<dim>;
      matrix        = 0.;
      rhs           = 0.;
      const QGauss<dim>                    quadrature(3);
      const QGauss<dim - 1>                face_quadrature(3);
      FEValues<dim>                        values(element,
                           quadrature,
                           update_values | update_gradients |
                             update_JxW_values);
      FEFaceValues<dim>                    face_values(element,
                                    face_quadrature,
                                    update_values | update_JxW_values);
      const unsigned int                   n = element.n_dofs_per_cell();
      FullMatrix<double>                   cell_matrix(n, n);
      dealii::Vector<double>               cell_rhs(n);
      std::vector<types::global_dof_index> indices(n);
      std::vector<Tensor<2, dim>>          grad_u(quadrature.size());
      std::vector<double>                  p_h(quadrature.size());
      std::vector<Tensor<2, dim>>          g(n);
      std::vector<SymmetricTensor<2, dim>> e(n);
      std::vector<double>                  N(n);
      for (const auto &cell : dofs.active_cell_iterators())
        {
          cell_matrix = 0.;
          cell_rhs    = 0.;
          values.reinit(cell);
          values[displacement].get_function_gradients(solution, grad_u);
          values[pressure].get_function_values(solution, p_h);
          for (unsigned int q = 0; q < quadrature.size(); ++q)
            {
              const Tensor<2, dim> F =
                Physics::Elasticity::Kinematics::F(grad_u[q]);
              const Tensor<2, dim>          F_inv = invert(F);
              const double                  J     = determinant(F);
              const double                  p = p_h[q], w = values.JxW(q);
              const SymmetricTensor<2, dim> b_bar =
                std::pow(J, -2. / 3.) * Physics::Elasticity::Kinematics::b(F);
              // Plane strain: the trace has three entries.
              const double trace_b_bar = trace(b_bar) + std::pow(J, -2. / 3.);
              const auto  &I           = Tensors::I;
              const SymmetricTensor<2, dim> tau_iso =
                G * (b_bar - trace_b_bar / 3. * I);
              const SymmetricTensor<2, dim> tau = tau_iso + p * J * I;
              const SymmetricTensor<4, dim> c =
                2. / 3. * G * trace_b_bar *
                  (Tensors::S - 1. / 3. * Tensors::IxI) -
                2. / 3. *
                  (outer_product(tau_iso, I) + outer_product(I, tau_iso)) +
                p * J * (Tensors::IxI - 2. * Tensors::S);
              for (unsigned int k = 0; k < n; ++k)
                {
                  g[k] = values[displacement].gradient(k, q) * F_inv;
                  e[k] = symmetrize(g[k]);
                  N[k] = values[pressure].value(k, q);
                }
              const double dilatation = 0.5 * (J - 1. / J); // U'(J) / K
              const double slope      = 0.5 * (J + 1. / J);
              for (unsigned int i = 0; i < n; ++i)
                {
                  cell_rhs(i) -= w * (e[i] * tau + N[i] * (dilatation - p / K));
                  for (unsigned int j = 0; j < n; ++j)
                    cell_matrix(i, j) +=
                      w * (e[i] * c * e[j] +
                           scalar_product(g[i] * Tensor<2, dim>(tau), g[j]) +
                           J * trace(e[i]) * N[j] +
                           N[i] * (slope * trace(e[j]) - N[j] / K));
                }
            }
          for (const auto &face : cell->face_iterators())
            if (face->at_boundary() && face->boundary_id() == 2)
              {
                face_values.reinit(cell, face);
                for (unsigned int q = 0; q < face_quadrature.size(); ++q)
                  for (unsigned int i = 0; i < n; ++i)
                    cell_rhs(i) += traction *
                                   face_values[displacement].value(i, q)[1] *
                                   face_values.JxW(q);
              }
          cell->get_dof_indices(indices);
          constraints.distribute_local_to_global(
            cell_matrix, cell_rhs, indices, matrix, rhs);
        }
    }

    const double                     K, G;
    const FEValuesExtractors::Vector displacement{0};
    const FEValuesExtractors::Scalar pressure{dim};
    Triangulation<dim>               mesh;
    const FESystem<dim>              element;
    DoFHandler<dim>                  dofs;
    AffineConstraints<double>        constraints;
    SparsityPattern                  pattern;
    SparseMatrix<double>             matrix;
    dealii::Vector<double>           solution, step, rhs;
  };
} // namespace

int
main(int argc, char **argv)
{
  if (argc != 3)
    {
      std::cerr << "cook_q2_p1 NU N\n";
      return 1;
    }
  Cook cook(std::atof(argv[1]), std::atoi(argv[2]));
  std::cout << argv[2] << " elements an edge, " << cook.n_dofs()
            << " unknowns: " << 1e3 * cook.rise() << " mm\n";
}
