#pragma once

#include <selkie/shape/support_table.h>
#include <selkie/time/newmark.h>

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <vector>

namespace selkie
{
  /// The kinematics of one point at the end of the step, computed once for
  /// all terms (design.md, section 2). 2D is plane strain: 3x3 throughout.
  template <int dim>
  struct PointKinematics
  {
    dealii::Tensor<2, 3> f; ///< incremental gradient
    dealii::Tensor<2, 3> f_inv;
    double               det_f = 1;
    double               J     = 1; ///< J_n det f
    dealii::Tensor<2, 3> l;         ///< velocity gradient (1/s), on request
    double               p = 0;     ///< sum N_a p_a (Pa), in fluids
    /// f^{-T} e_j: gradients push forward as g_a = sum_j (grad_n N_a)_j c_j.
    std::array<dealii::Tensor<1, 3>, dim> c;
  };

  /**
   * What the terms leave at one point; the assembler turns the sum of all
   * terms into nodal forces and one dense block (with G_a = grad_n N_a):
   *
   *   R_a    = flux G_a + source N_a
   *   R_p,a  = p_source N_a + lumped N_a (p_a - p)
   *   K_ab   = sum_jl stiffness[j][l] G_aj G_bl + mass N_a N_b I
   *   K_up   = (coupling G_a) N_b, K_pu its transpose
   *   K_pp   = p_stiffness N_a N_b + lumped (N_a delta_ab - N_a N_b)
   */
  template <int dim>
  struct PointForm
  {
    dealii::Tensor<2, dim>                                   flux;
    dealii::Tensor<1, dim>                                   source;
    std::array<std::array<dealii::Tensor<2, dim>, dim>, dim> stiffness;
    double                                                   mass = 0;

    double                 p_source = 0, p_stiffness = 0, lumped = 0;
    dealii::Tensor<2, dim> coupling;

    /// Adds the force sum V_0 tau g_a.
    void
    add_stress(const double                V_0,
               const dealii::Tensor<2, 3> &tau,
               const PointKinematics<dim> &point)
    {
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          flux[i][j] += V_0 * (tau[i] * point.c[j]);
    }

    /// Adds the tangent K_ab = V_0 A(g_a, g_b), a bilinear form in the two
    /// gradients that returns a second-order tensor.
    template <typename BilinearForm>
    void
    add_tangent(const double                V_0,
                const PointKinematics<dim> &point,
                const BilinearForm         &A)
    {
      for (unsigned int j = 0; j < dim; ++j)
        for (unsigned int l = 0; l < dim; ++l)
          {
            const dealii::Tensor<2, 3> K = A(point.c[j], point.c[l]);
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int k = 0; k < dim; ++k)
                stiffness[j][l][i][k] += V_0 * K[i][k];
          }
    }
  };

  /**
   * A form in the mean gradient of a patch, for terms that need one; empty
   * otherwise. With gbar_a = sum_q gradient_q G_a and
   * E_a = sum_q coupling_q G_a:
   *
   *   R_a  += force gbar_a
   *   K_ab += E_a (x) gbar_b + gbar_a (x) E_b + stiffness gbar_a (x) gbar_b
   */
  template <int dim>
  struct MeanForm
  {
    std::vector<dealii::Tensor<2, dim>> gradient, coupling; ///< by point
    double                              force = 0, stiffness = 0;
  };

  /// Time and its discretisation during a step.
  struct StepTime
  {
    double  t_n = 0; ///< s
    Newmark newmark;

    double
    t() const
    {
      return t_n + newmark.dt;
    }
  };

  /// One patch, gathered: what the terms read and where they write.
  template <int dim>
  struct PatchState
  {
    const Patch<dim>        *patch = nullptr;
    const SupportTable<dim> *table = nullptr;
    const StepTime          *time  = nullptr;

    std::vector<PointKinematics<dim>>   kinematics;
    std::vector<dealii::Tensor<1, dim>> velocity;     ///< on request
    std::vector<dealii::Tensor<1, dim>> acceleration; ///< on request
    std::vector<dealii::Tensor<1, dim>> increment;    ///< on request
    std::vector<PointForm<dim>>         forms;
    MeanForm<dim>                       mean;

    /// Cell size (m).
    double
    h() const
    {
      return patch->cell->extent_in_direction(0);
    }

    const StepPoint<dim> &
    point(const unsigned int q) const
    {
      return table->points[patch->first_point + q];
    }
  };
} // namespace selkie
