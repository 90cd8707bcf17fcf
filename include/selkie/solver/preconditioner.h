#pragma once

#include <selkie/assembly/system.h>
#include <selkie/base/types.h>

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
  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_jacobi(const System<dim> &system);

  /// The inverse of the dim x dim diagonal block of each node.
  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_node_block_jacobi(const System<dim> &system);

  /// ML on the matrix itself, with the rigid-body modes of the nodes.
  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_ml(const System<dim> &system);

  /// For the displacements of LME: see TwoLevel. Needs System::hats().
  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_hats(const System<dim> &system);

  /**
   * For the mixed system [A B; B^T -C], upper block triangular:
   *   P = [A B; 0 -S],  S = C + B^T D^{-1} B,  D = diag(A),
   * S^{-1} by TwoLevel with S of the hat functions as its coarse matrix, A^{-1}
   * by TwoLevel, or by node blocks where A is nearly diagonal (lumped masses of
   * fluids, as long as neither solids nor viscosity couple the nodes). Counts
   * iterations as the block LDL^T of solver.md, section 4, does, and inverts A
   * once instead of twice (doc/performance.md). Without System::hats() the
   * system's own functions are hats.
   */
  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_block_triangular(const System<dim> &system);
} // namespace selkie
