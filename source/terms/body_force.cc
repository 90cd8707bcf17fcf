#include <selkie/terms/term_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// R_a = -sum_p m N_a b(X, x, t). The force is a dead load: it is taken at
    /// the position at t_n and at the time t_{n+1}, so it has no tangent.
    template <int dim>
    class BodyForceTerm : public Term<dim>
    {
    public:
      explicit BodyForceTerm(std::shared_ptr<VectorExpression<dim>> force)
        : force(std::move(force))
      {}

      std::string
      name() const override
      {
        return "body force";
      }

      TermNeeds
      needs() const override
      {
        TermNeeds needs;
        needs.increment = true;
        return needs;
      }

      bool
      acts_on(const Patch<dim> &patch) const override
      {
        return patch.matter;
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
      Tensor<1, dim>
      load(const PatchState<dim> &state, const unsigned int q) const
      {
        const StepPoint<dim> &point = state.point(q);
        return point.mass * force->value(point.x, state.time->t(), point.X);
      }

      const std::shared_ptr<VectorExpression<dim>> force;
    };
  } // namespace

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_body_force(std::shared_ptr<VectorExpression<dim>> force)
  {
    return std::make_unique<BodyForceTerm<dim>>(std::move(force));
  }

  template std::unique_ptr<const Term<2>>
    make_body_force<2>(std::shared_ptr<VectorExpression<2>>);
  template std::unique_ptr<const Term<3>>
    make_body_force<3>(std::shared_ptr<VectorExpression<3>>);
} // namespace selkie
