#include <selkie/solver/tangent_blocks.h>

#include <Epetra_CrsMatrix.h>
#include <Epetra_Vector.h>

namespace selkie
{
  using namespace dealii;

  // --- of a matrix -----------------------------------------------------------

  template <int dim>
  MatrixBlocks<dim>::MatrixBlocks(const System<dim> &system)
    : system(system)
    , B(system, Part::displacements, Part::pressures)
    , BT(system, Part::pressures, Part::displacements)
    , C(system, Part::pressures, Part::pressures)
  {}

  template <int dim>
  void
  MatrixBlocks<dim>::vmult_B(FloatVector &y, const FloatVector &x) const
  {
    B.vmult(y, x);
  }

  template <int dim>
  void
  MatrixBlocks<dim>::vmult_pressures(FloatVector &y, const FloatVector &x) const
  {
    x.update_ghost_values();
    y = 0.f;
    BT.vmult_add(y, 1.f, x);
    C.vmult_add(y, 1.f, x);
    x.zero_out_ghost_values();
  }

  template <int dim>
  std::unique_ptr<const FloatBlock>
  MatrixBlocks<dim>::displacements() const
  {
    return displacements_of(system);
  }

  template <int dim>
  std::shared_ptr<NodeDiagonal<dim, float>>
  MatrixBlocks<dim>::node_diagonal() const
  {
    return diagonal_of_matrix<dim, float>(system);
  }

  template <int dim>
  FloatVector
  MatrixBlocks<dim>::D_inverse() const
  {
    FloatVector             inverse = float_vector(system);
    const Epetra_CrsMatrix &K       = system.matrix().epetra();
    Epetra_Vector           diagonal(K.RowMap());
    K.ExtractDiagonalCopy(diagonal);
    for (unsigned int i = 0; i < system.n_owned_displacements(); ++i)
      inverse.local_element(i) = 1. / diagonal[i];
    inverse.update_ghost_values();
    return inverse;
  }

  /// B is the transpose of B^T.
  template <int dim>
  FloatVector
  MatrixBlocks<dim>::schur_diagonal(const FloatVector &D_inverse) const
  {
    FloatVector result(float_vector(system));
    C.for_each([&](const unsigned int row,
                   const unsigned int column,
                   const float        value) {
      if (row == column)
        result.local_element(row) -= value;
    });
    BT.for_each([&](const unsigned int row,
                    const unsigned int column,
                    const float        value) {
      result.local_element(row) +=
        value * value * D_inverse.local_element(column);
    });
    return result;
  }

  // --- at the points ---------------------------------------------------------

  template <int dim>
  PointBlocks<dim>::PointBlocks(const System<dim> &system)
    : tangent(*system.points())
    , coupling(tangent)
    , node_blocks(tangent.node_blocks())
  {}

  template <int dim>
  void
  PointBlocks<dim>::vmult_B(FloatVector &y, const FloatVector &x) const
  {
    coupling.vmult_B(y, x);
  }

  template <int dim>
  void
  PointBlocks<dim>::vmult_pressures(FloatVector &y, const FloatVector &x) const
  {
    coupling.vmult_pressures(y, x);
  }

  template <int dim>
  std::unique_ptr<const PointTangent<dim, float>>
  PointBlocks<dim>::displacements() const
  {
    return std::make_unique<const PointTangent<dim, float>>(tangent);
  }

  template <int dim>
  std::shared_ptr<NodeDiagonal<dim, float>>
  PointBlocks<dim>::node_diagonal() const
  {
    return std::make_shared<NodeDiagonal<dim, float>>(node_blocks);
  }

  template <int dim>
  FloatVector
  PointBlocks<dim>::D_inverse() const
  {
    FloatVector inverse;
    inverse.reinit(tangent.partitioner());
    for (unsigned int node = 0; node < node_blocks.size(); ++node)
      for (unsigned int i = 0; i < dim; ++i)
        inverse.local_element(dim * node + i) = 1. / node_blocks[node][i][i];
    inverse.update_ghost_values();
    return inverse;
  }

  template <int dim>
  FloatVector
  PointBlocks<dim>::schur_diagonal(const FloatVector &D_inverse) const
  {
    return coupling.schur_diagonal(D_inverse);
  }

  template class MatrixBlocks<2>;
  template class MatrixBlocks<3>;
  template class PointBlocks<2>;
  template class PointBlocks<3>;
} // namespace selkie
