#include <selkie/terms/term_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// R_a = -sum_p m N_a g, on the material points in every cell.
    template <int dim>
    class GravityTerm : public Term<dim>
    {
    public:
      explicit GravityTerm(const Tensor<1, dim> &g)
        : g(g)
      {}

      std::string
      name() const override
      {
        return "gravity";
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
          state.forms[q].source -= state.point(q).mass * g;
      }

    private:
      const Tensor<1, dim> g;
    };
  } // namespace

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_gravity(const Tensor<1, dim> &g)
  {
    return std::make_unique<GravityTerm<dim>>(g);
  }

  template std::unique_ptr<const Term<2>>
  make_gravity<2>(const Tensor<1, 2> &);
  template std::unique_ptr<const Term<3>>
  make_gravity<3>(const Tensor<1, 3> &);
} // namespace selkie
