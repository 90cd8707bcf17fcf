#include <selkie/terms/dead_load.h>
#include <selkie/terms/term_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// R_a = -sum_p A_p N_a t(X, x, t); A_p is the face's reference area that a
    /// point carries (a dead load): of the outermost material points of a body,
    /// or of the Gauss points of finite elements' faces.
    template <int dim>
    class TractionTerm : public DeadLoad<dim>
    {
    public:
      explicit TractionTerm(const std::vector<Traction<dim>> &tractions)
        : tractions(tractions)
      {}

      std::string
      name() const override
      {
        return "traction";
      }

      bool
      acts_on(const Patch<dim> &patch) const override
      {
        return patch.matter || patch.surface;
      }

    private:
      Tensor<1, dim>
      load(const PatchState<dim> &state, const unsigned int q) const override
      {
        const StepPoint<dim> &point = state.point(q);
        Tensor<1, dim>        sum;
        if (point.traction_area != 0.)
          for (const auto &traction : tractions)
            if (traction.body == point.body)
              sum += point.traction_area *
                     traction.value->value(point.x, state.time->t(), point.X);
        return sum;
      }

      const std::vector<Traction<dim>> tractions;
    };
  } // namespace

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_traction(const std::vector<Traction<dim>> &tractions)
  {
    return std::make_unique<TractionTerm<dim>>(tractions);
  }

  template std::unique_ptr<const Term<2>>
  make_traction<2>(const std::vector<Traction<2>> &);
  template std::unique_ptr<const Term<3>>
  make_traction<3>(const std::vector<Traction<3>> &);
} // namespace selkie
