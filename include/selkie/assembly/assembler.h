#pragma once

#include <selkie/assembly/dense_patch.h>
#include <selkie/assembly/hat_patch.h>
#include <selkie/assembly/system.h>
#include <selkie/assembly/tangent_scatter.h>
#include <selkie/base/cost_ledger.h>
#include <selkie/shape/support_table.h>
#include <selkie/terms/term.h>

#include <array>
#include <memory>
#include <vector>

namespace selkie
{
  /// The fields at t_n and the iterate, on the unknowns' numbering, with
  /// ghosts. Without inertia there is x alone. Entries of mass, v_n and a_n at
  /// pressure unknowns are zero.
  struct StepFields
  {
    Vector mass; ///< lumped
    Vector v_n, a_n;
    Vector x; ///< the iterate: displacement increments (m) and pressures (Pa)

    /// Velocity at t_{n+1} of a displacement unknown (local index), m/s.
    double
    velocity(const Newmark &newmark, const unsigned int i) const
    {
      return v_n.size() == 0 ? newmark.velocity(x.local_element(i), 0., 0.)
                             : newmark.velocity(x.local_element(i),
                                                v_n.local_element(i),
                                                a_n.local_element(i));
    }
  };

  /**
   * The one loop over the patches: gather, kinematics, run the terms, turn
   * their point forms into a dense block, scatter. Residual and tangent come
   * from the same code path.
   *
   * What is done with a patch is a list of steps for its kind, composed at
   * set-up from what the active terms read and write: in the loops nothing is
   * asked about effects (doc/design-notes.md, section 1).
   */
  template <int dim>
  class Assembler
  {
  public:
    using Terms = std::vector<std::shared_ptr<const Term<dim>>>;

    Assembler(const Terms &terms, System<dim> &system);

    /**
     * Residual at @p fields.x, prescribed rows included (they hold minus the
     * reactions), summed over the ranks.
     * @param with_tangent also fills the tangent that the System has, points()
     *        or else matrix(), and hats(), if there is that: rows and columns
     *        of prescribed unknowns keep their diagonal only, and pressure rows
     *        and columns are multiplied by @p pressure_unit (Pa).
     * Throws InvertedPoint when det f is not above 0.05 at some point; on
     * every rank.
     */
    void
    assemble(const SupportTable<dim> &table,
             const StepTime          &time,
             StepFields              &fields,
             const double             pressure_unit,
             const bool               with_tangent,
             Vector                  &residual);

    /// Energies that leave or enter through the terms at the present iterate,
    /// summed over the ranks.
    struct Powers
    {
      double dissipation   = 0; ///< heat produced (W)
      double external_work = 0; ///< of dead loads during the step (J)
    };
    Powers
    powers(const SupportTable<dim> &table,
           const StepTime          &time,
           StepFields              &fields);

    /// What the terms cost so far.
    /// Adds to the costs of another assembler of the same terms.
    void
    go_on_from(const CostLedger &costs)
    {
      ledger = costs;
    }

    const CostLedger &
    costs() const
    {
      return ledger;
    }

  private:
    /// One step before the terms, for one patch. False if a point is inverted.
    using Preparation = bool (Assembler::*)(const Patch<dim> &);

    /// All that is done with the patches of one kind.
    struct Kernel
    {
      std::vector<Preparation>                    prepare;
      std::vector<unsigned int>                   terms; ///< in `terms`
      std::vector<typename DensePatch<dim>::Step> forces, block;
      bool with_pressure = false, with_mass = false;
    };
    Kernel
    compose(const PatchKind &kind, const bool for_energy) const;
    static std::vector<Preparation>
    preparations(const TermUse &used);

    // The steps of a kernel, in this order.
    bool
    gather_increments(const Patch<dim> &patch);
    bool
    gather_velocities(const Patch<dim> &patch);
    bool
    gather_accelerations(const Patch<dim> &patch);
    bool
    gather_pressures(const Patch<dim> &patch);
    bool
    point_kinematics(const Patch<dim> &patch);
    bool
    point_velocity_gradients(const Patch<dim> &patch);
    bool
    point_pressures(const Patch<dim> &patch);
    bool
    point_velocities(const Patch<dim> &patch);
    bool
    point_accelerations(const Patch<dim> &patch);
    bool
    point_increments(const Patch<dim> &patch);

    void
    gather(const Patch<dim>              &patch,
           const Vector                  &from,
           dealii::AlignedVector<double> &values) const;
    std::vector<dealii::Tensor<1, dim>>
    interpolate(const Patch<dim>                    &patch,
                const dealii::AlignedVector<double> &values) const;

    void
    begin(const SupportTable<dim> &table,
          const StepTime          &time,
          StepFields              &fields);
    bool
    prepare(const Kernel &kernel, const Patch<dim> &patch);
    bool
    add_patch(const Kernel     &kernel,
              const Patch<dim> &patch,
              const bool        with_tangent,
              Vector           &residual);
    void
    add_at_nodes(const StepTime   &time,
                 const StepFields &fields,
                 const bool        with_tangent,
                 Vector           &residual);
    void
    add_hats(const Kernel &kernel);
    void
    number_unknowns(const unsigned int        *nodes,
                    const unsigned int         phase,
                    const DensePatch<dim>     &dense,
                    std::vector<unsigned int> &unknowns) const;
    void
    scatter_residual(const Patch<dim> &patch, Vector &residual) const;

    const Terms                           &terms;
    System<dim>                           &system;
    TermUse                                use; ///< of all terms
    std::array<Kernel, PatchKind::n_kinds> kernels, energy_kernels;
    std::vector<const Term<dim> *>         node_terms;
    CostLedger                             ledger;

    Vector velocity, acceleration; ///< of the iterate, with ghosts, on request

    // Scratch of one patch.
    const StepFields     *iterate = nullptr;
    PatchState<dim>       state;
    DensePatch<dim>       dense, hat_dense;
    HatPatch<dim>         hat_patch;
    std::vector<unsigned> unknowns, hat_unknowns; ///< component-major
    TangentScatter<dim>   tangent, hat_tangent;
  };
} // namespace selkie
