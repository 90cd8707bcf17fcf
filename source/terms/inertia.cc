#include <selkie/terms/term_table.h>

namespace selkie
{
  namespace
  {
    /// R_a = sum_b M_ab a_b, K_ab = alpha1 M_ab, with the lumped mass
    /// M_a = sum_p m N_a or the consistent M_ab = sum_p m N_a N_b.
    template <int dim>
    class InertiaTerm : public Term<dim>
    {
    public:
      explicit InertiaTerm(const MassKind mass)
        : lumped(mass == MassKind::lumped)
      {}

      std::string
      name() const override
      {
        return "inertia";
      }

      TermNeeds
      needs() const override
      {
        TermNeeds needs;
        needs.acceleration = !lumped;
        return needs;
      }

      bool
      acts_on(const Patch<dim> &patch) const override
      {
        return !lumped && patch.matter;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        for (unsigned int q = 0; q < state.patch->n_points; ++q)
          {
            const double m = state.point(q).mass;
            state.forms[q].source += m * state.acceleration[q];
            if (with_tangent)
              state.forms[q].mass += m * state.time->newmark.alpha1;
          }
      }

      void
      add_at_nodes(const NodeState &state,
                   const Newmark   &newmark,
                   Vector          &residual,
                   Vector          *diagonal) const override
      {
        if (!lumped)
          return;
        for (unsigned int i = 0; i < residual.locally_owned_size(); ++i)
          residual.local_element(i) += state.lumped_mass.local_element(i) *
                                       state.acceleration.local_element(i);
        if (diagonal != nullptr)
          for (unsigned int i = 0; i < residual.locally_owned_size(); ++i)
            diagonal->local_element(i) +=
              newmark.alpha1 * state.lumped_mass.local_element(i);
      }

    private:
      const bool lumped;
    };
  } // namespace

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_inertia(const Inertia &inertia)
  {
    return std::make_unique<InertiaTerm<dim>>(inertia.mass);
  }

  template std::unique_ptr<const Term<2>>
  make_inertia<2>(const Inertia &);
  template std::unique_ptr<const Term<3>>
  make_inertia<3>(const Inertia &);
} // namespace selkie
