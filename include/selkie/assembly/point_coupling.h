#pragma once

#include <selkie/assembly/point_tangent.h>
#include <selkie/base/types.h>

#include <deal.II/base/aligned_vector.h>

#include <vector>

namespace selkie
{
  /**
   * What couples pressures with displacements and with each other in a
   * PointTangent, [A B; B^T C] without A, in single precision: a copy for
   * preconditioners that depends on nothing. With D_a = coupling_q G_a in the
   * points,
   *
   *   (B p)_a   = sum_q p_q D_a,                       p_q = sum_b N_b p_b,
   *   (B^T u)_a = sum_q (sum_b D_b . u_b) N_a,
   *   (C p)_a   = sum_q stiffness_q p_q N_a + diagonal_a p_a.
   */
  template <int dim>
  class PointCoupling
  {
  public:
    using VectorType = dealii::LinearAlgebra::distributed::Vector<float>;

    explicit PointCoupling(const PointTangent<dim, double> &tangent);

    /// y = B x, zero at the pressures; vectors in the system's layout.
    /// Collective.
    void
    vmult_B(VectorType &y, const VectorType &x) const;

    /// y = B^T x_u + C x_p, zero at the displacements. Collective.
    void
    vmult_pressures(VectorType &y, const VectorType &x) const;

    /// About the diagonal of B^T D^{-1} B - C at the owned pressures: the sum
    /// B_ab of what patches give is squared patch by patch. Collective.
    /// @param D_inverse for each displacement, with ghosts
    VectorType
    schur_diagonal(const VectorType &D_inverse) const;

  private:
    using Lanes                         = simd::NativeOf<float>;
    static constexpr unsigned int lanes = sizeof(Lanes) / sizeof(float);

    /// A patch. Its functions are N and D of each point.
    struct Cell
    {
      unsigned int n_points, n_nodes, n_padded;
      unsigned int first_node;  ///< in displacements and pressures
      unsigned int first_point; ///< in stiffnesses
      std::size_t  functions;
    };

    void
    add_cell(const PointTangent<dim, double>         &tangent,
             const typename PointTangentLayout::Cell &from,
             float                                  *&next);
    void
    distribute(const VectorType &x) const;
    void
    collect(VectorType &y) const;
    void
    gather(const Cell &cell) const;
    void
    add_B(const Cell &cell, float *y) const;
    void
    add_pressures(const Cell &cell, float *y) const;
    void
    add_schur_diagonal(const Cell       &cell,
                       const VectorType &D_inverse,
                       VectorType       &result) const;

    std::vector<Cell>            cells;
    std::vector<unsigned int>    displacements; ///< the first of each node
    std::vector<unsigned int>    pressures;     ///< of each node
    std::vector<unsigned int>    held;          ///< owned
    std::vector<float>           stiffnesses;
    dealii::AlignedVector<float> functions;
    unsigned int                 first_pressure; ///< of the owned unknowns
    VectorType                   diagonal;

    // Scratch: a vector with its ghosts, and what belongs to one patch.
    mutable VectorType                   wide;
    mutable dealii::AlignedVector<float> values, fluxes;
  };
} // namespace selkie
