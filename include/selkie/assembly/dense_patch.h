#pragma once

#include <selkie/terms/term.h>

#include <deal.II/base/aligned_vector.h>

namespace selkie
{
  /**
   * The dense algebra of one patch: nodal values in, nodal forces and one
   * dense block out. Arrays are component-major and padded to SIMD lanes:
   * entry (component c, node a) stands at c * n_padded + a, with the pressure
   * as component dim where a term writes its equation. Rows of the block are in
   * the order of the matrix instead: node by node, then the pressures.
   */
  template <int dim>
  class DensePatch
  {
  public:
    /// @param with_pressure whether the block has the rows of the pressure
    void
    reinit(const Patch<dim> &patch, const bool with_pressure);

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

    /// A step in the integration of a patch's point forms.
    using Step = void (DensePatch::*)(const PatchState<dim> &);

    /// The steps that turn what such terms write into nodal forces, and into
    /// the dense block; none for what no term writes.
    static std::vector<Step>
    force_steps(const TermUse &use);
    static std::vector<Step>
    block_steps(const TermUse &use);

    /// Row (node a, component c) of the block: row_length() values.
    const double *
    row(const unsigned int a, const unsigned int c) const
    {
      return block.data() + std::size_t(a * n_components + c) * row_length();
    }

    unsigned int
    row_length() const
    {
      return n_components * n_padded;
    }

    /// Where the unknown (node a, component c) stands in a row of the block.
    unsigned int
    place(const unsigned int a, const unsigned int c) const
    {
      return c < dim ? dim * a + c : dim * n_padded + a;
    }

  private:
    template <bool stress, bool source>
    void
    set_forces(const PatchState<dim> &state);
    void
    add_volume_forces(const PatchState<dim> &state);
    void
    add_mean_forces(const PatchState<dim> &state);
    template <int n_components, bool mass>
    void
    set_block(const PatchState<dim> &state);
    void
    add_mean_block(const PatchState<dim> &state);

    /// sum_q tensors_q G_a, component-major like force.
    dealii::AlignedVector<double>
    mean_vector(const PatchState<dim>                     &state,
                const std::vector<dealii::Tensor<2, dim>> &tensors) const;

    dealii::AlignedVector<double> block;
  };
} // namespace selkie
