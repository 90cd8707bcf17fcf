#pragma once

#include <selkie/terms/term.h>

namespace selkie
{
  /// A force on material points that does not depend on the unknowns: it is
  /// taken at the position at t_n and at the time t_{n+1}, so it has no
  /// tangent; its work is external. R_a = -sum_p load N_a.
  template <int dim>
  class DeadLoad : public Term<dim>
  {
  public:
    TermUse
    use() const override
    {
      TermUse use;
      use.source = true;
      use.energy = true;
      return use;
    }

    bool
    acts_on(const PatchKind &kind) const override
    {
      return kind.matter;
    }

    void
    add(PatchState<dim> &state, const bool) const override
    {
      for (unsigned int q = 0; q < state.patch->n_points; ++q)
        state.forms[q].source -= load(state, q);
    }

    double
    external_work(const PatchState<dim> &state) const override
    {
      double work = 0.;
      for (unsigned int q = 0; q < state.patch->n_points; ++q)
        work += load(state, q) * state.increment[q];
      return work;
    }

  private:
    /// Force on one point (N; N/m in 2D).
    virtual dealii::Tensor<1, dim>
    load(const PatchState<dim> &state, const unsigned int q) const = 0;
  };
} // namespace selkie
