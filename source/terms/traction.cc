#include <selkie/terms/term_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// R_a = -sum_p A_p N_a t(X, x, t) over the outermost points of a face; A_p
    /// is the face's reference area that a point carries (a dead load).
    template <int dim>
    class TractionTerm : public Term<dim>
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

      TermNeeds
      needs() const override
      {
        return TermNeeds();
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
          {
            const StepPoint<dim> &point = state.point(q);
            for (unsigned int i = 0; i < tractions.size(); ++i)
              if (point.traction_area != 0. && tractions[i].body == point.body)
                state.forms[q].source -=
                  point.traction_area *
                  tractions[i].value->value(point.x, state.time->t(), point.X);
          }
      }

    private:
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
