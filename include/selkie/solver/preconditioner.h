#pragma once

#include <selkie/assembly/system.h>
#include <selkie/base/types.h>

#include <deal.II/lac/trilinos_precondition.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <memory>
#include <vector>

namespace selkie
{
  /// The one place for preconditioners: x = P^{-1} b on the unknowns'
  /// numbering.
  class Preconditioner
  {
  public:
    virtual ~Preconditioner() = default;

    virtual void
    vmult(Vector &x, const Vector &b) const = 0;
  };

  /// 1/|K_ii|.
  std::unique_ptr<const Preconditioner>
  make_jacobi(const dealii::TrilinosWrappers::SparseMatrix &matrix);

  /// The inverse of the dim x dim diagonal block of each node.
  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_node_block_jacobi(const System<dim>                            &system,
                         const dealii::TrilinosWrappers::SparseMatrix &matrix);

  /// ML smoothed aggregation with the rigid-body modes of the nodes,
  /// threshold 0.02, Chebyshev smoother of degree 2 (solver.md, section 2).
  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_ml(const System<dim>                            &system,
          const dealii::TrilinosWrappers::SparseMatrix &matrix);

  /**
   * For LME: Chebyshev sweeps of degree 2 on System::matrix(), one V-cycle of
   * ML on the hat functions' matrix System::hats() of the same nodes, and the
   * sweeps again (solver.md, section 2): ML sees 9 points (27 in 3D) where LME
   * couples 50 to 200, and the sweeps see the short waves, which LME makes
   * softer.
   */
  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_hats(const System<dim> &system);

  /**
   * Block LDL^T for the mixed system [A B; B^T -C] (solver.md, section 4):
   *   P = [A 0; B^T -S] [I A^{-1} B; 0 I],  S = C + B^T D^{-1} B,
   * D = diag(A), A^{-1} by Jacobi (fluids) or ML (with solids), S^{-1} by ML.
   */
  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_block_ldlt(const System<dim>                            &system,
                  const dealii::TrilinosWrappers::SparseMatrix &matrix,
                  const bool multigrid_for_displacements);
} // namespace selkie
