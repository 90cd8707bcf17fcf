#include <selkie/terms/dead_load.h>
#include <selkie/terms/term_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// R_a = -sum_p m N_a b(X, x, t). A dead load.
    template <int dim>
    class BodyForceTerm : public DeadLoad<dim>
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

    private:
      Tensor<1, dim>
      load(const PatchState<dim> &state, const unsigned int q) const override
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
