#pragma once

#include <selkie/shape/lme.h>

namespace selkie
{
  /**
   * LME functions on a Cartesian box of nodes with equal beta, as products of
   * dim one-dimensional LME functions (L10)-(L12). This is exact: exp and Z
   * factorise. A helper of lme_evaluate(), which has the arguments' meaning.
   *
   * @return the number of Newton steps, at least 1, or 0 if the point is left
   *   to the general kernel: close to the boundary of the box or outside, or
   *   for lines of more than 32 nodes or with gamma (n-1)^2 > 500. lambda is
   *   then unchanged.
   */
  template <int dim>
  unsigned int
  lme_tensor_product(const LmeNodes<dim>      &nodes,
                     const dealii::Point<dim> &x,
                     dealii::Tensor<1, dim>   &lambda,
                     double                   *N,
                     double                   *grad,
                     const LmeSettings        &settings);
} // namespace selkie
