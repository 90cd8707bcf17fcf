#pragma once

#include <selkie/laws/law.h>

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>
#include <deal.II/grid/tria.h>

#include <vector>

namespace selkie
{
  /**
   * What the points of a patch are for. Material points have `matter`: mass,
   * weight and transfer are summed over them. Points over which the internal
   * force is summed have `integration`. Both hold except in full fluid cells,
   * where a second patch of fixed Gauss points integrates (quadrature.md,
   * section 3). The points of a loaded face of a finite element have `surface`
   * and nothing else, those of a wall that a fluid touches `surface` and
   * `fluid`, pairs of nodes in contact (contact_pairs.h) `contact`. Matter
   * whose pressure is an unknown of its own has `pressure`.
   */
  struct PatchKind
  {
    bool fluid       = false;
    bool matter      = true;
    bool integration = true;
    bool surface     = false;
    bool contact     = false;
    bool pressure    = false;

    static constexpr unsigned int n_kinds = 64;

    /// One number for each kind, less than n_kinds.
    unsigned int
    index() const
    {
      return fluid + 2 * matter + 4 * integration + 8 * surface + 16 * contact +
             32 * pressure;
    }
  };

  /**
   * Points that share one node list: the points of one phase in one cell, with
   * all nodes that any of them reaches. One patch gives one dense block of the
   * tangent.
   */
  template <int dim>
  struct Patch : PatchKind
  {
    using Cell = typename dealii::Triangulation<dim>::active_cell_iterator;

    Cell         cell;
    unsigned int phase = 0;

    unsigned int first_point = 0, n_points = 0; ///< in SupportTable::points
    unsigned int first_node = 0, n_nodes = 0;   ///< in SupportTable::nodes
    unsigned int n_padded = 0;                  ///< n_nodes up to SIMD lanes
    std::size_t  data     = 0;                  ///< in SupportTable::data
  };

  /// A point during one step: its state at t_n, which nothing changes before
  /// the step has converged.
  template <int dim>
  struct StepPoint
  {
    dealii::Point<dim>     x; ///< position at t_n (m)
    const Law             *law    = nullptr;
    double                 mass   = 0;   ///< kg; zero for Gauss points
    double                 volume = 0;   ///< reference volume V_0
    dealii::Tensor<2, dim> F_n;          ///< solids and Lagrangian meshes
    double                 J_n = 1;      ///< where there is a pressure
    dealii::Point<dim>     X;            ///< reference position, on request
    double                 area     = 0; ///< of a surface, m^2 (m in 2D)
    unsigned int           body     = 0;
    unsigned int           particle = 0; ///< place in the iteration order
    dealii::Tensor<1, dim> lambda;       ///< LME multiplier found
  };

  /**
   * The seam between the approximations: patches, their points and nodes, and
   * the shape functions N_a and gradients grad_n N_a with step n as the
   * reference. LME-MPM and Q4 FEM differ only in who fills it.
   *
   * For point q of a patch the values start at N(patch, q) and the derivative
   * in direction d at gradient(patch, q, d): n_padded doubles each, padded
   * with zeros.
   */
  template <int dim>
  struct SupportTable
  {
    std::vector<Patch<dim>>       patches;
    std::vector<StepPoint<dim>>   points;
    std::vector<unsigned int>     nodes; ///< indices into the NodeCloud
    dealii::AlignedVector<double> data;

    unsigned int       n_particles       = 0; ///< owned material points
    unsigned long long newton_iterations = 0; ///< for lambda, material points
    unsigned int       max_newton_iterations = 0;

    const double *
    N(const Patch<dim> &patch, const unsigned int q) const
    {
      return data.data() + patch.data + q * (dim + 1) * patch.n_padded;
    }

    const double *
    gradient(const Patch<dim>  &patch,
             const unsigned int q,
             const unsigned int d) const
    {
      return N(patch, q) + (d + 1) * patch.n_padded;
    }

    /// Room for @p n more numbers in data, at once: to grow with the patches
    /// would leave half of it, and holes in the heap, unused.
    void
    reserve_data(const std::size_t n)
    {
      const std::size_t needed = data.size() + n;
      if (needed > data.capacity())
        data.reserve(needed + needed / 16); // steps are alike, not equal
    }

    void
    clear()
    {
      patches.clear();
      points.clear();
      nodes.clear();
      data.resize_fast(0);
      n_particles           = 0;
      newton_iterations     = 0;
      max_newton_iterations = 0;
    }
  };
} // namespace selkie
