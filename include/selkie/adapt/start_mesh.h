#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/scene/scene.h>

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/tria.h>

#include <memory>

namespace selkie
{
  /// The nodes of a mesh that the scene's approximation is made of. Collective.
  template <int dim>
  std::unique_ptr<NodeCloud<dim>>
  make_node_cloud(
    const Scene<dim>                                        &scene,
    const dealii::parallel::distributed::Triangulation<dim> &mesh);

  /// The background mesh of a scene at its start: with the effect `adaptivity`
  /// already adapted to the matter that will be seeded in it. Collective.
  template <int dim>
  std::unique_ptr<dealii::parallel::distributed::Triangulation<dim>>
  make_start_mesh(const Scene<dim> &scene, const MPI_Comm comm);
} // namespace selkie
