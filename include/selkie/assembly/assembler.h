#pragma once

#include <selkie/assembly/dense_patch.h>
#include <selkie/assembly/system.h>
#include <selkie/shape/support_table.h>
#include <selkie/terms/term.h>

#include <memory>
#include <vector>

namespace selkie
{
  /// The fields at t_n and the iterate, on the unknowns' numbering, with
  /// ghosts. Entries of mass, v_n and a_n at pressure unknowns are zero.
  struct StepFields
  {
    Vector mass; ///< lumped
    Vector v_n, a_n;
    Vector x; ///< the iterate: displacement increments (m) and pressures (Pa)
  };

  /**
   * The one loop over the patches: gather, kinematics, run the terms, turn
   * their point forms into a dense block, scatter. Residual and tangent come
   * from the same code path.
   */
  template <int dim>
  class Assembler
  {
  public:
    using Terms = std::vector<std::unique_ptr<const Term<dim>>>;

    Assembler(const Terms &terms, System<dim> &system);

    /**
     * Residual at @p fields.x, prescribed rows included (they hold minus the
     * reactions), summed over the ranks.
     * @param with_tangent also fills System::matrix(): rows and columns of
     *        prescribed unknowns keep their diagonal only, and pressure rows
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

  private:
    void
    compute_nodal_kinematics(const Newmark &newmark, const StepFields &fields);
    bool
    prepare(const SupportTable<dim> &table,
            const Patch<dim>        &patch,
            const StepTime          &time,
            const StepFields        &fields);
    void
    scatter_residual(const SupportTable<dim> &table,
                     const Patch<dim>        &patch,
                     Vector                  &residual) const;
    void
    scatter_tangent(const SupportTable<dim> &table,
                    const Patch<dim>        &patch,
                    const double             pressure_unit);
    /// One row of the dense block to the rank that owns it.
    void
    add_row(const unsigned int row,
            const Patch<dim>  &patch,
            const double       row_unit,
            const double       pressure_unit,
            const double      *block);
    void
    add_diagonal(const Vector &diagonal);

    const Terms &terms;
    System<dim> &system;
    TermNeeds    needs; ///< of all terms

    Vector velocity, acceleration; ///< of the iterate, with ghosts

    // Scratch of one patch.
    PatchState<dim>       state;
    DensePatch<dim>       dense;
    std::vector<unsigned> unknowns;  ///< local indices, component-major
    std::vector<int>      positions; ///< of a row's columns, -1 elsewhere
    std::vector<dealii::types::global_dof_index> global_columns;
    std::vector<double>                          row_values;
  };
} // namespace selkie
