#include <selkie/adapt/adapt_mesh.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/forest.h>
#include <selkie/output/audit.h>
#include <selkie/particles/rearrange.h>
#include <selkie/transfer/recall_points.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Splits and merges points until they fit their cells: a split halves
    /// them once, and the mesh may have become finer by several levels. Whether
    /// there was anything to do.
    template <int dim>
    bool
    fit_points(ParticleSet<dim> &particles)
    {
      const Adaptivity &wishes = *particles.scene.adaptivity;
      const bool merges = wishes.points == PointAdaptation::split_and_merge;
      bool       any    = false;
      for (unsigned int i = 0; i <= wishes.finer + wishes.coarser; ++i)
        {
          const auto done = rearrange(particles, true, merges);
          any             = any || done.split + done.merged > 0;
          if (done.split + done.merged == 0)
            break;
        }
      return any;
    }

    /// The body that holds a place, or their number.
    template <int dim>
    unsigned int
    body_at(const Scene<dim> &scene, const Point<dim> &x)
    {
      unsigned int b = 0;
      while (b < scene.bodies.size() && !scene.bodies[b].shape->contains(x))
        ++b;
      return b;
    }

    /// Whether one element could take the place of a cell and its siblings:
    /// elements fit their bodies.
    template <int dim>
    bool
    can_be_joined(const Scene<dim>                    &scene,
                  const typename NodeCloud<dim>::Cell &cell)
    {
      const auto parent = cell->parent();
      const auto body   = body_at(scene, parent->child(0)->center());
      for (unsigned int c = 1; c < parent->n_children(); ++c)
        if (body_at(scene, parent->child(c)->center()) != body)
          return false;
      return true;
    }

    /// Flags the cells for one level towards what is wanted.
    template <int dim>
    CellFlags
    flag(parallel::distributed::Triangulation<dim> &mesh,
         const NodeCloud<dim>                      &nodes,
         const Scene<dim>                          &scene,
         const WantedLevels<dim>                   &wanted)
    {
      const Adaptivity  &wishes = *scene.adaptivity;
      const unsigned int lowest = base_level(scene.domain) - wishes.coarser;
      return flag_cells<dim>(
        mesh,
        nodes,
        wanted,
        [&](const typename NodeCloud<dim>::Cell &cell) {
          const unsigned int least =
            std::max(lowest, refined_level(scene.domain, cell));
          const unsigned int level = cell->level();
          return scene.lagrangian_mesh() && level > least &&
                     !can_be_joined(scene, cell)
                   ? level
                   : least;
        },
        wishes.most_cells);
    }

    /// Makes the mesh that the flags say, and lets points and fields follow.
    template <int dim>
    void
    follow_flags(parallel::distributed::Triangulation<dim> &mesh,
                 ParticleSet<dim>                          &particles,
                 CarriedFields<dim>                        &fields)
    {
      const auto next =
        flagged_forest<dim>(mesh, [&particles](const auto &cell) {
          return particles.weight(cell);
        });
      fields.carry_over([&] {
        particles.remesh([&] { rebuild(particles.scene.domain, mesh, *next); });
      });
      if (particles.scene.lagrangian_mesh() && !fields.values.empty())
        fields.make_continuous();
    }

    /// Changes the mesh, as planned, until it is what is wanted.
    template <int dim>
    void
    follow_plan(parallel::distributed::Triangulation<dim> &mesh,
                ParticleSet<dim>                          &particles,
                const AdaptPlan<dim>                      &plan,
                CarriedFields<dim>                        &fields)
    {
      const Adaptivity &wishes = *particles.scene.adaptivity;
      if (particles.scene.lagrangian_mesh() && !fields.values.empty())
        fields.make_continuous();
      follow_flags(mesh, particles, fields);
      CellFlags flags = plan.first;
      for (unsigned int i = 0; flags.more && i < wishes.finer + wishes.coarser;
           ++i)
        {
          flags =
            flag(mesh, NodeCloud<dim>(mesh), particles.scene, plan.wanted);
          if (!flags.any())
            break;
          follow_flags(mesh, particles, fields);
        }
    }
  } // namespace


  template <int dim>
  AdaptPlan<dim>
  plan_adaptation(parallel::distributed::Triangulation<dim> &mesh,
                  const ParticleSet<dim>                    &particles,
                  const NodeCloud<dim>                      &cloud,
                  const NodalView<dim>                      &nodes)
  {
    AdaptPlan<dim> plan{{wanted_parts(particles, cloud, nodes),
                         particles.communicator()},
                        {},
                        particles.imbalance() > most_imbalance};
    plan.first = flag(mesh, cloud, particles.scene, plan.wanted);
    return plan;
  }


  template <int dim>
  AdaptReport
  adapt_mesh(parallel::distributed::Triangulation<dim> &mesh,
             ParticleSet<dim>                          &particles,
             const AdaptPlan<dim>                      &plan,
             CarriedFields<dim>                        &fields)
  {
    const Scene<dim> &scene   = particles.scene;
    const bool        changes = plan.changes_mesh();
    const bool        fits    = !scene.lagrangian_mesh() &&
                      scene.adaptivity->points != PointAdaptation::keep;
    if (!changes && !fits)
      return {};
    const auto energy = [&particles, &scene] {
      return scene.audit ? audit(particles).energy() : 0.;
    };
    const double before = energy();
    if (changes)
      follow_plan(mesh, particles, plan, fields);
    bool new_points = false;
    if (fits)
      new_points = fit_points(particles);
    else if (scene.lagrangian_mesh() && !fields.values.empty())
      {
        recall_points(particles, fields);
        new_points = true;
      }
    return {changes, new_points ? energy() - before : 0.};
  }


#define INSTANTIATE(dim)                                                       \
  template AdaptPlan<dim> plan_adaptation(                                     \
    parallel::distributed::Triangulation<dim> &,                               \
    const ParticleSet<dim> &,                                                  \
    const NodeCloud<dim> &,                                                    \
    const NodalView<dim> &);                                                   \
  template AdaptReport adapt_mesh(parallel::distributed::Triangulation<dim> &, \
                                  ParticleSet<dim> &,                          \
                                  const AdaptPlan<dim> &,                      \
                                  CarriedFields<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
