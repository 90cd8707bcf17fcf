#pragma once

#include <selkie/base/exceptions.h>

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <string>

/**
 * @file
 * Kinematics at one point, in 3x3 tensors throughout: a plane-strain problem
 * is a 3D one with F_33 = 1. Theory: doc/theory.md, section 1.
 */
namespace selkie
{
  using dealii::Tensor;

  /// The 3x3 identity.
  inline Tensor<2, 3>
  identity()
  {
    return dealii::unit_symmetric_tensor<3>();
  }

  /// Symmetric part of @p l, in the units of @p l.
  inline Tensor<2, 3>
  sym(const Tensor<2, 3> &l)
  {
    return 0.5 * (l + dealii::transpose(l));
  }

  /// Deviator a - (tr a)/3 I with the three-dimensional trace, plane strain
  /// included.
  inline Tensor<2, 3>
  dev(const Tensor<2, 3> &a)
  {
    return a - dealii::trace(a) / 3. * identity();
  }

  /// The 3x3 tensor whose upper left block is @p a. @p zz is the out-of-plane
  /// entry in 2D: 1 for deformation gradients, 0 for velocity gradients. In 3D
  /// it is not used.
  template <int dim>
  Tensor<2, 3>
  extend(const Tensor<2, dim> &a, const double zz = 1.)
  {
    Tensor<2, 3> result;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        result[i][j] = a[i][j];
    if (dim == 2)
      result[2][2] = zz;
    return result;
  }

  /// The 3-vector whose first entries are @p a, the others zero.
  template <int dim>
  Tensor<1, 3>
  extend(const Tensor<1, dim> &a)
  {
    Tensor<1, 3> result;
    for (unsigned int i = 0; i < dim; ++i)
      result[i] = a[i];
    return result;
  }

  /// @throw InvertedPoint unless @p J > 0 (a NaN throws too).
  inline void
  check_not_inverted(const double J)
  {
    if (!(J > 0.))
      throw InvertedPoint("det F = " + std::to_string(J) +
                          " at an integration point; it must be positive");
  }

  /// Invariants of the left (or right) Cauchy-Green tensor; no units.
  struct Invariants
  {
    double I1; ///< tr b
    double I2; ///< ((tr b)^2 - tr b^2) / 2
    double J;  ///< det F = sqrt(det b)
  };

  /// Left Cauchy-Green tensor b = F F^T.
  inline Tensor<2, 3>
  left_cauchy_green(const Tensor<2, 3> &F)
  {
    return F * dealii::transpose(F);
  }

  /// The invariants of @p b = F F^T, given @p J = det F.
  /// @throw InvertedPoint if @p J <= 0.
  inline Invariants
  invariants(const Tensor<2, 3> &b, const double J)
  {
    check_not_inverted(J);
    const double I1 = dealii::trace(b);
    return {I1, 0.5 * (I1 * I1 - dealii::scalar_product(b, b)), J};
  }

  /// The invariants of F F^T for a deformation gradient @p F.
  /// @throw InvertedPoint if det F <= 0.
  inline Invariants
  invariants(const Tensor<2, 3> &F)
  {
    return invariants(left_cauchy_green(F), dealii::determinant(F));
  }
} // namespace selkie
