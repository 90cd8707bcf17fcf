#pragma once

#include <selkie/assembly/point_coupling.h>
#include <selkie/solver/displacement_block.h>
#include <selkie/solver/float_block.h>

#include <memory>
#include <utility>
#include <vector>

namespace selkie
{
  /**
   * The tangent of a system with pressures, [A B; B^T C], in single precision
   * for preconditioners: copied from the matrix, or at the points. Both have
   *
   * - vmult_B(y, x): y = B x, zero at the pressures;
   * - vmult_pressures(y, x): y = B^T x_u + C x_p, zero at the displacements;
   * - displacements(): A, as an operator of its own;
   * - node_diagonal(): the inverse of its node blocks, and D_inverse(), that of
   *   its diagonal, with ghosts;
   * - schur_diagonal(D_inverse): that of B^T D^{-1} B - C, or nearly so, at the
   *   pressures.
   *
   * Products are collective; vectors are like float_vector(system). The other
   * three are of the tangent that the system has when they are called.
   */
  template <int dim>
  class MatrixBlocks
  {
  public:
    using Displacements = FloatBlock;

    explicit MatrixBlocks(const System<dim> &system);

    void
    vmult_B(FloatVector &y, const FloatVector &x) const;
    void
    vmult_pressures(FloatVector &y, const FloatVector &x) const;
    std::unique_ptr<const FloatBlock>
    displacements() const;
    std::shared_ptr<NodeDiagonal<dim, float>>
    node_diagonal() const;
    FloatVector
    D_inverse() const;
    FloatVector
    schur_diagonal(const FloatVector &D_inverse) const;

  private:
    const System<dim> &system;
    const FloatBlock   B, BT, C;
  };

  /// See MatrixBlocks.
  template <int dim>
  class PointBlocks
  {
  public:
    using Displacements = PointTangent<dim, float>;

    explicit PointBlocks(const System<dim> &system);

    void
    vmult_B(FloatVector &y, const FloatVector &x) const;
    void
    vmult_pressures(FloatVector &y, const FloatVector &x) const;
    std::unique_ptr<const PointTangent<dim, float>>
    displacements() const;
    std::shared_ptr<NodeDiagonal<dim, float>>
    node_diagonal() const;
    FloatVector
    D_inverse() const;
    FloatVector
    schur_diagonal(const FloatVector &D_inverse) const;

  private:
    const PointTangent<dim, double> &tangent;
    const PointCoupling<dim>         coupling;

    const std::vector<dealii::Tensor<2, dim>> node_blocks; ///< A's
  };
} // namespace selkie
