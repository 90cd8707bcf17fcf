#include <selkie/adapt/adapt_mesh.h>
#include <selkie/adapt/start_mesh.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/particles/particle_set.h>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  std::unique_ptr<NodeCloud<dim>>
  make_node_cloud(const Scene<dim>                                &scene,
                  const parallel::distributed::Triangulation<dim> &mesh)
  {
    if (scene.approximation != Approximation::lme_mpm)
      return std::make_unique<NodeCloud<dim>>(mesh);
    return std::make_unique<NodeCloud<dim>>(mesh,
                                            scene.lme.gamma,
                                            scene.lme.support_tolerance,
                                            scene.n_layers());
  }


  namespace
  {
    /// The points are seeded again on the adapted mesh, until it fits them.
    template <int dim>
    void
    adapt_to_seeds(const Scene<dim>                          &scene,
                   parallel::distributed::Triangulation<dim> &mesh)
    {
      const Adaptivity  &wishes = *scene.adaptivity;
      CarriedFields<dim> none;
      ParticleSet<dim>   particles(scene, mesh);
      for (unsigned int i = 0; i <= wishes.finer + wishes.coarser; ++i)
        {
          particles.seed();
          const auto plan =
            plan_adaptation(mesh, particles, *make_node_cloud(scene, mesh), {});
          if (!plan.changes_mesh())
            return;
          adapt_mesh(mesh, particles, plan, none);
        }
    }
  } // namespace


  template <int dim>
  std::unique_ptr<parallel::distributed::Triangulation<dim>>
  make_start_mesh(const Scene<dim> &scene, const MPI_Comm comm)
  {
    auto mesh = make_background_mesh(scene.domain, comm);
    if (scene.adaptivity)
      adapt_to_seeds(scene, *mesh);
    return mesh;
  }


#define INSTANTIATE(dim)                                                    \
  template std::unique_ptr<NodeCloud<dim>> make_node_cloud(                 \
    const Scene<dim> &, const parallel::distributed::Triangulation<dim> &); \
  template std::unique_ptr<parallel::distributed::Triangulation<dim>>       \
  make_start_mesh(const Scene<dim> &, const MPI_Comm)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
