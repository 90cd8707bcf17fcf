#pragma once

#include <selkie/terms/patch_state.h>

#include <deal.II/base/aligned_vector.h>

namespace selkie
{
  /**
   * The dense algebra of one patch: nodal values in, nodal forces and one
   * dense block out. Arrays are component-major and padded to SIMD lanes:
   * entry (component c, node a) stands at c * n_padded + a, with the pressure
   * as component dim in fluid patches.
   */
  template <int dim>
  class DensePatch
  {
  public:
    void
    reinit(const Patch<dim> &patch);

    unsigned int n_nodes = 0, n_padded = 0, n_components = 0;

    dealii::AlignedVector<double> du, velocity, acceleration; ///< gathered
    dealii::AlignedVector<double> p;
    dealii::AlignedVector<double> force; ///< out

    /// sum_a values_a (x) G_a for a vector field.
    dealii::Tensor<2, dim>
    gradient(const dealii::AlignedVector<double> &values,
             const double                        *G) const;

    /// sum_a N_a values_a for one component.
    double
    value(const double *values, const double *N) const;

    /// Nodal forces of the point forms: sums over the points.
    void
    integrate_forces(const PatchState<dim> &state);

    /// The dense block of the point forms.
    void
    integrate_block(const PatchState<dim> &state);

    /// Row (node a, component c) of the block: n_components * n_padded values.
    const double *
    row(const unsigned int a, const unsigned int c) const
    {
      return block.data() +
             std::size_t(a * n_components + c) * n_components * n_padded;
    }

  private:
    /// sum_q tensors_q G_a, component-major like force.
    dealii::AlignedVector<double>
    mean_vector(const PatchState<dim>                     &state,
                const std::vector<dealii::Tensor<2, dim>> &tensors) const;
    void
    add_mean_block(const PatchState<dim> &state);

    dealii::AlignedVector<double> block;
  };
} // namespace selkie
