#include <selkie/adapt/adapt_mesh.h>
#include <selkie/adapt/flag_cells.h>
#include <selkie/mesh/background_mesh.h>
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

    /// One level towards what is wanted; whether the mesh has changed.
    template <int dim>
    bool
    adapt_once(parallel::distributed::Triangulation<dim> &mesh,
               ParticleSet<dim>                          &particles,
               const WantedLevels<dim>                   &wanted,
               const bool                                 anyway,
               CarriedFields<dim>                        &fields)
    {
      const Domain<dim>   &domain = particles.scene.domain;
      const Adaptivity    &wishes = *particles.scene.adaptivity;
      const NodeCloud<dim> nodes(mesh);
      const unsigned int   lowest = base_level(domain) - wishes.coarser;
      const CellFlags      flags  = flag_cells<dim>(
        mesh,
        nodes,
        wanted,
        [&](const typename NodeCloud<dim>::Cell &cell) {
          const unsigned int least =
            std::max(lowest, refined_level(domain, cell));
          const unsigned int level = cell->level();
          return particles.scene.lagrangian_mesh() && level > least &&
                     !can_be_joined(particles.scene, cell)
                         ? level
                         : least;
        },
        wishes.most_cells);
      if (flags.refined + flags.coarsened == 0 && !anyway)
        return false;
      fields.carry_along([&] {
        particles.remesh([&mesh] { mesh.execute_coarsening_and_refinement(); });
      });
      if (particles.scene.lagrangian_mesh() && !fields.values.empty())
        fields.make_continuous();
      return true;
    }
  } // namespace


  template <int dim>
  AdaptReport
  adapt_mesh(parallel::distributed::Triangulation<dim> &mesh,
             ParticleSet<dim>                          &particles,
             const NodeCloud<dim>                      &cloud,
             const NodalView<dim>                      &nodes,
             CarriedFields<dim>                        &fields)
  {
    const Scene<dim>       &scene  = particles.scene;
    const Adaptivity       &wishes = *scene.adaptivity;
    const WantedLevels<dim> wanted(wanted_parts(particles, cloud, nodes),
                                   particles.communicator());
    const auto              energy = [&particles, &scene] {
      return scene.audit ? audit(particles).energy() : 0.;
    };
    const double before = energy();
    AdaptReport  report;
    bool         anyway = particles.imbalance() > most_imbalance;
    for (unsigned int pass = 0; pass <= wishes.finer + wishes.coarser; ++pass)
      {
        if (!adapt_once(mesh, particles, wanted, anyway, fields))
          break;
        report.changed = true;
        anyway         = false;
      }
    bool new_points = false;
    if (scene.lagrangian_mesh())
      {
        new_points = report.changed && !fields.values.empty();
        if (new_points)
          recall_points(particles, fields);
      }
    else if (wishes.points != PointAdaptation::keep)
      new_points = fit_points(particles);
    if (new_points)
      report.energy = energy() - before;
    return report;
  }


#define INSTANTIATE(dim)                                                       \
  template AdaptReport adapt_mesh(parallel::distributed::Triangulation<dim> &, \
                                  ParticleSet<dim> &,                          \
                                  const NodeCloud<dim> &,                      \
                                  const NodalView<dim> &,                      \
                                  CarriedFields<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
