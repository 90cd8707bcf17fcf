#pragma once

#include <selkie/scene/scene.h>

#include <deal.II/grid/tria.h>

namespace selkie
{
  /// Reads the file or calls the generator, without refinement.
  /// @throw SceneError when that fails, with deal.II's reason.
  template <int dim>
  void
  make_coarse_mesh(const ImportedMesh         &mesh,
                   dealii::Triangulation<dim> &triangulation);

  /// Puts the box of the domain around its imported mesh.
  /// @throw SceneError as above.
  template <int dim>
  void
  fit_box(Domain<dim> &domain);
} // namespace selkie
