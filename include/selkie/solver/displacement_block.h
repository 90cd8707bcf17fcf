#pragma once

#include <selkie/assembly/point_tangent.h>
#include <selkie/assembly/system.h>
#include <selkie/solver/float_block.h>
#include <selkie/solver/multigrid.h>
#include <selkie/solver/two_level.h>

#include <deal.II/base/tensor.h>

#include <Epetra_CrsMatrix.h>

#include <memory>
#include <utility>
#include <vector>

namespace selkie
{
  /// The inverses of the diagonal blocks of the nodes' displacements.
  template <int dim, typename Number>
  class NodeDiagonal
  {
  public:
    explicit NodeDiagonal(const unsigned int n_nodes)
      : blocks(n_nodes)
    {}

    /// @param blocks of the diagonal, not yet inverted
    template <typename OtherNumber>
    explicit NodeDiagonal(
      const std::vector<dealii::Tensor<2, dim, OtherNumber>> &blocks)
      : blocks(blocks.begin(), blocks.end())
    {
      invert();
    }

    void
    add(const unsigned int row, const unsigned int column, const double value)
    {
      if (row / dim == column / dim)
        blocks[row / dim][row % dim][column % dim] = value;
    }

    void
    invert()
    {
      for (auto &block : blocks)
        block = dealii::invert(block);
    }

    template <typename VectorType>
    void
    vmult(VectorType &x, const VectorType &b) const
    {
      for (unsigned int node = 0; node < blocks.size(); ++node)
        for (unsigned int i = 0; i < dim; ++i)
          {
            Number sum = 0.;
            for (unsigned int j = 0; j < dim; ++j)
              sum += blocks[node][i][j] * b.local_element(node * dim + j);
            x.local_element(node * dim + i) = sum;
          }
      for (unsigned int i = dim * blocks.size(); i < x.locally_owned_size();
           ++i)
        x.local_element(i) = 0.;
    }

  private:
    std::vector<dealii::Tensor<2, dim, Number>> blocks;
  };

  /// Of the system's matrix.
  template <int dim, typename Number>
  std::shared_ptr<NodeDiagonal<dim, Number>>
  diagonal_of_matrix(const System<dim> &system)
  {
    const unsigned int n = system.n_owned_displacements();
    auto    diagonal     = std::make_shared<NodeDiagonal<dim, Number>>(n / dim);
    int    *start, *column;
    double *values;
    system.matrix().epetra().ExtractCrsDataPointers(start, column, values);
    for (unsigned int i = 0; i < n; ++i)
      for (int k = start[i]; k < start[i + 1]; ++k)
        diagonal->add(i, column[k], values[k]);
    diagonal->invert();
    return diagonal;
  }

  /// Of a copy of a matrix.
  template <int dim>
  std::shared_ptr<NodeDiagonal<dim, float>>
  diagonal_of(const FloatBlock &A, const unsigned int n_nodes)
  {
    auto diagonal = std::make_shared<NodeDiagonal<dim, float>>(n_nodes);
    A.for_each([&](const unsigned int row,
                   const unsigned int column,
                   const float value) { diagonal->add(row, column, value); });
    diagonal->invert();
    return diagonal;
  }

  /// Of a tangent that stays at the points.
  template <int dim>
  std::shared_ptr<NodeDiagonal<dim, float>>
  diagonal_of(const PointTangent<dim, float> &A, const unsigned int)
  {
    return std::make_shared<NodeDiagonal<dim, float>>(A.node_blocks());
  }

  /// A vector to multiply the system's tangent with.
  template <int dim>
  FloatVector
  float_vector(const System<dim> &system)
  {
    if (!system.points())
      return float_vector(system.matrix());
    FloatVector result;
    result.reinit(system.partitioner());
    return result;
  }

  /// The displacement block of the system's tangent, and what is near its
  /// inverse.
  template <int dim, typename Operator>
  class DisplacementBlock
  {
  public:
    /// @param hats the same block of the hat functions' matrix; it has to
    ///   outlive this
    DisplacementBlock(const System<dim>                &system,
                      const Epetra_CrsMatrix           &hats,
                      std::unique_ptr<const Operator> &&block)
      : A(std::move(block))
      , inverse(*A,
                diagonal_of<dim>(*A, system.n_owned_displacements() / dim),
                float_vector(system),
                0,
                system.n_owned_displacements(),
                std::make_unique<const Multigrid>(hats,
                                                  dim,
                                                  node_places(system),
                                                  rigid_body_modes(system)))
    {}

    const std::unique_ptr<const Operator>              A;
    const TwoLevel<Operator, NodeDiagonal<dim, float>> inverse;
  };

  /// A copy of the matrix's block.
  template <int dim>
  std::unique_ptr<const FloatBlock>
  displacements_of(const System<dim> &system)
  {
    return std::make_unique<const FloatBlock>(system,
                                              Part::displacements,
                                              Part::displacements);
  }

} // namespace selkie
