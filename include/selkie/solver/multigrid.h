#pragma once

#include <selkie/assembly/system.h>

#include <Epetra_CrsMatrix.h>
#include <Epetra_Vector.h>

#include <memory>
#include <vector>

namespace ML_Epetra
{
  class MultiLevelPreconditioner;
}

namespace selkie
{
  /// Views of the owned values as Epetra vectors; no copies.
  Epetra_Vector
  epetra_view(const Epetra_BlockMap &map, const double *values);

  /**
   * ML: smoothed aggregation, threshold 0.02, Chebyshev smoother of degree 2
   * (solver.md, section 2). With near-null modes for displacements, without for
   * scalars. The matrix must outlive it.
   */
  class Multigrid
  {
  public:
    /// @param places of the owned nodes, a list for each direction: on several
    ///   ranks, coarse levels are collected on fewer of them by these
    Multigrid(const Epetra_CrsMatrix            &matrix,
              const unsigned int                 n_equations,
              std::vector<std::vector<double>> &&places,
              std::vector<std::vector<double>> &&modes = {});
    ~Multigrid();

    /// x = P b, owned values.
    void
    apply(const double *b, double *x) const;

  private:
    std::vector<std::vector<double>>                     places;
    std::vector<double>                                  null_space;
    std::unique_ptr<ML_Epetra::MultiLevelPreconditioner> ml;
  };

  /// Places of the owned nodes, a list for each direction (m).
  template <int dim>
  std::vector<std::vector<double>>
  node_places(const System<dim> &system);

  /// Translations and rotations at the owned nodes; zero where they are held.
  template <int dim>
  std::vector<std::vector<double>>
  rigid_body_modes(const System<dim> &system);
} // namespace selkie
