#pragma once

#include <selkie/scene/scene.h>

#include <deal.II/base/point.h>
#include <deal.II/distributed/tria.h>

#include <vector>

namespace selkie
{
  /// A material point to be.
  template <int dim>
  struct Seed
  {
    typename dealii::Triangulation<dim>::active_cell_iterator cell;
    dealii::Point<dim> x, reference; ///< position; the same in the unit cell
    unsigned int       body;         ///< index into Scene::bodies
    double             volume;       ///< share of the body's exact volume
    unsigned long long id;           ///< 0, 1, …, the same on any partition
  };

  /**
   * The material points of all bodies in this rank's cells: in each cell a
   * lattice of Body::points_per_direction points a direction, kept where
   * inside the shape and then displaced by at most Body::jitter of their
   * spacing a direction, unless that would take them out of the shape. The
   * random numbers depend on cell and body only. Volumes are scaled so that
   * they sum up to Shape::volume(). With a Lagrangian mesh: the Gauss points
   * of the cells whose centres lie in the body, Body::points_per_direction a
   * direction. Collective.
   *
   * Throws SceneError on all ranks when a body gets no point, or when two
   * bodies claim the same one, or when finite elements do not fit a body.
   */
  template <int dim>
  std::vector<Seed<dim>>
  seed_points(const Scene<dim>                                        &scene,
              const dealii::parallel::distributed::Triangulation<dim> &mesh);
} // namespace selkie
