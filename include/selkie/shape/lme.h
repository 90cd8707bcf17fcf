#pragma once

#include <selkie/base/exceptions.h>

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <vector>

/**
 * @file
 * Local maximum-entropy (LME) shape functions of Arroyo & Ortiz, IJNME 65
 * (2006) 2167-2202, with one beta per node. With d_a = x - x_a,
 *
 *   N_a(x) = exp(-beta_a |d_a|^2 + lambda . d_a) / Z,
 *
 * where lambda(x) is such that sum_a N_a d_a = 0. Equation numbers (L1), (L2)
 * ... in this folder are those of doc/theory.md.
 */
namespace selkie
{
  /// Node lists are padded to a multiple of this many entries (SIMD lanes).
  constexpr unsigned int lme_padding = 8;

  /// The length of a padded list of n nodes.
  inline unsigned int
  lme_padded(const unsigned int n)
  {
    return (n + lme_padding - 1) / lme_padding * lme_padding;
  }

  /**
   * The nodes that the points of a patch share, as a structure of arrays. It
   * is filled by reinit() or make_box(); entries n ... n_padded-1 repeat node 0
   * and get no weight.
   */
  template <int dim>
  struct LmeNodes
  {
    /// The true number of nodes, and that with the padding.
    unsigned int n        = 0;
    unsigned int n_padded = 0;

    /// Coordinates (m): x[d][a], each of n_padded entries.
    std::array<dealii::AlignedVector<double>, dim> x;

    /// beta_a = gamma/h_a^2 (1/m^2), n_padded entries.
    dealii::AlignedVector<double> beta;

    /// Length scale (m): the smallest nodal spacing. Tolerances refer to it.
    double h = 1.;

    /// All beta_a are equal: the gradient has a simpler form (L6).
    bool uniform_beta = true;

    /// The list is a full Cartesian box of spacing h with equal beta; node
    /// (i,j,k) has the index i + n_x (j + n_y k). Set by make_box() only.
    bool                          is_box   = false;
    std::array<unsigned int, dim> box_size = {};
    dealii::Point<dim>            box_origin;

    /// exp(-2 beta h^2), used on boxes.
    double box_decay = 0.;

    /**
     * Any list of nodes. It never looks for a box: a caller who knows that the
     * list is one uses make_box().
     * @param points the nodes (m)
     * @param node_beta beta_a of each node (1/m^2)
     * @param spacing h (m)
     */
    void
    reinit(const std::vector<dealii::Point<dim>> &points,
           const std::vector<double>             &node_beta,
           const double                           spacing);

    /**
     * The nodes origin + spacing (i,j,k), 0 <= i < size[0] and so on, all with
     * the same beta (1/m^2). Each size must be at least 2.
     */
    static LmeNodes
    make_box(const dealii::Point<dim>            &origin,
             const double                         spacing,
             const std::array<unsigned int, dim> &size,
             const double                         beta);
  };

  /// When Newton's iteration for lambda stops.
  struct LmeSettings
  {
    /// Converged when |sum_a N_a d_a| < tolerance * h.
    double tolerance = 1e-12;

    /// Bound on the iterations of one attempt; a point at a wall needs two
    /// attempts.
    unsigned int max_iterations = 60;
  };

  /**
   * Evaluates all N_a(x) and grad N_a(x) of any list, by (L1)-(L7).
   *
   * Points on the boundary of the hull of the nodes (walls, edges, corners),
   * or nearer to it than about 1e-9 h, have no bounded lambda that is of use:
   * there the functions are evaluated 1e-8 h further inside and brought back
   * with their gradients (L8). Partition of unity and linear reproduction stay
   * exact to round-off, N_a has an error of order 1e-16 and grad N_a of order
   * 1e-8/h; lambda is then that of the inner point.
   *
   * @param nodes the list
   * @param x the point (m)
   * @param lambda in: start of the iteration, zero if nothing better is known;
   *   out: the multiplier (1/m)
   * @param N n_padded values; zero in the padding
   * @param grad null, or dim * n_padded values, grad[d * n_padded + a] =
   *   dN_a/dx_d (1/m); zero in the padding
   * @return the number of Newton steps
   * @throws OutsideHull if x lies outside the hull by more than round-off
   *   (1e-12 h plus a few ulp of x), if all nodes lie in one plane, or if there
   *   are less than dim+1 nodes. lambda and the output are then undefined.
   */
  template <int dim>
  unsigned int
  lme_evaluate(const LmeNodes<dim>      &nodes,
               const dealii::Point<dim> &x,
               dealii::Tensor<1, dim>   &lambda,
               double                   *N,
               double                   *grad,
               const LmeSettings        &settings = {});

  /**
   * lme_evaluate() for many points of one list. On a box the functions are
   * products of one-dimensional ones (L10)-(L13), with the points in the SIMD
   * lanes: the same functions to round-off, several times faster. Points that
   * this is not made for, at the boundary of the box above all, and other
   * lists go to lme_evaluate(). The result for a point does not depend on the
   * points beside it.
   *
   * @param nodes the list
   * @param x the points (m)
   * @param lambda as in lme_evaluate(), one for each point (1/m)
   * @param values (dim+1) * n_padded values for each point, N and then grad
   *   of lme_evaluate()
   * @return the number of Newton steps of all points; those on boxes count the
   *   last check
   * @throws OutsideHull as lme_evaluate(), with the first such point. All
   *   lambda and the output are then undefined.
   */
  template <int dim>
  unsigned int
  lme_evaluate_points(const LmeNodes<dim>                   &nodes,
                      const std::vector<dealii::Point<dim>> &x,
                      std::vector<dealii::Tensor<1, dim>>   &lambda,
                      double                                *values,
                      const LmeSettings                     &settings = {});

  /// Distance R (m) at which exp(-gamma r^2/h^2) falls to the given tolerance.
  double
  lme_support_radius(const double h,
                     const double gamma,
                     const double tolerance);
} // namespace selkie
