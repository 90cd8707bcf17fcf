#pragma once

#include <selkie/assembly/dense_patch.h>
#include <selkie/assembly/system.h>

#include <vector>

namespace selkie
{
  /**
   * Adds the dense blocks of patches to a matrix, straight into its arrays.
   * Rows and columns of prescribed unknowns keep their diagonal only; pressure
   * rows and columns are multiplied by a unit.
   */
  template <int dim>
  class TangentScatter
  {
  public:
    explicit TangentScatter(const System<dim> &system)
      : system(system)
    {}

    /// Sets a matrix to zero and points at it.
    void
    begin(SystemMatrix &matrix, const double pressure_unit);

    /// @param unknowns of the patch, component-major
    void
    add(const std::vector<unsigned int> &unknowns,
        const DensePatch<dim>           &dense);

    /// Adds to the diagonal of owned rows.
    void
    add_diagonal(const Vector &diagonal);

    /// Sends what belongs to other ranks. Collective.
    void
    finish();

  private:
    void
    set_columns(const std::vector<unsigned int> &unknowns,
                const DensePatch<dim>           &dense);
    void
    set_factors(const std::vector<unsigned int> &unknowns,
                const DensePatch<dim>           &dense);
    void
    add_row(const unsigned int row,
            const unsigned int place,
            const double      *block);

    const System<dim> &system;
    SystemMatrix      *matrix = nullptr;
    double             unit   = 1;

    // Of one patch: its columns, positions being those in a row of the block;
    // what a row or column is multiplied by (zero if held), in the block's
    // order; whether none is held.
    std::vector<ColumnRun> columns;
    std::vector<double>    factors;
    bool                   free = true;

    // Of one group of rows: where its entries stand in those of the matrix.
    std::vector<unsigned int> positions;
  };
} // namespace selkie
