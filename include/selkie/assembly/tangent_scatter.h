#pragma once

#include <selkie/assembly/dense_patch.h>
#include <selkie/assembly/system.h>

#include <vector>

namespace selkie
{
  /**
   * Adds the dense blocks of patches to a sparse matrix, straight into its
   * arrays. Rows and columns of prescribed unknowns keep their diagonal only;
   * pressure rows and columns are multiplied by a unit.
   */
  template <int dim>
  class TangentScatter
  {
  public:
    explicit TangentScatter(const System<dim> &system)
      : system(system)
    {}

    /// Sets a matrix to zero and points at it.
    /// @param columns Epetra's local column of each unknown (local index)
    void
    begin(dealii::TrilinosWrappers::SparseMatrix &matrix,
          const std::vector<int>                 &columns,
          const double                            pressure_unit);

    /// @param unknowns of the patch, component-major, as the block is
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
    set_factors(const std::vector<unsigned int> &unknowns,
                const DensePatch<dim>           &dense);
    void
    find_positions(const unsigned int row);
    void
    add_node(const unsigned int               a,
             const std::vector<unsigned int> &unknowns,
             const DensePatch<dim>           &dense);
    void
    add_to_other_rank(const unsigned int               row,
                      const double                     factor,
                      const std::vector<unsigned int> &unknowns,
                      const DensePatch<dim>           &dense,
                      const double                    *block);

    const System<dim>                      &system;
    dealii::TrilinosWrappers::SparseMatrix *matrix    = nullptr;
    const std::vector<int>                 *columns   = nullptr;
    double                                  unit      = 1;
    int                                    *row_start = nullptr;
    int                                    *column    = nullptr;
    double                                 *values    = nullptr;

    // Of one patch: what a row or column is multiplied by (zero if held), and
    // the matrix columns.
    std::vector<double> factors;
    std::vector<int>    patch_columns;
    // Of one row: where its columns stand, and the patch's among them.
    std::vector<int> positions, patch_positions;

    std::vector<dealii::types::global_dof_index> global_columns;
    std::vector<double>                          row_values;
  };
} // namespace selkie
