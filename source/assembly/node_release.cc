#include <selkie/assembly/node_release.h>

#include <deal.II/base/mpi.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Then nodes are only let go: a set that swings between two states must
    /// come to an end.
    constexpr unsigned int corrections_both_ways = 5;
    constexpr unsigned int most_corrections      = 10;
  } // namespace

  template <int dim>
  NodeRelease<dim>::NodeRelease(const Scene<dim>    &scene,
                                NodeConditions<dim> &conditions)
    : conditions(conditions)
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (const auto condition = scene.domain.walls[w].condition;
          scene.release->walls[w] && (condition == NodeCondition::slip ||
                                      condition == NodeCondition::fixed))
        walls |= 1u << w;
    for (const unsigned int b : scene.release->bodies)
      phases |= 1u << scene.bodies[b].phase;
    if (scene.release->bodies.empty())
      phases = ~1u; // all solids
  }

  template <int dim>
  void
  NodeRelease<dim>::begin_step(const NodeCloud<dim> &cloud)
  {
    kept.resize(cloud.size(), 0);
    released    = kept;
    corrections = 0;
    apply(cloud);
  }

  template <int dim>
  const Vector &
  NodeRelease<dim>::kept_walls(const NodeCloud<dim> &cloud)
  {
    kept.resize(cloud.size(), 0);
    kept_numbers.reinit(cloud.partitioner());
    for (unsigned int node = 0; node < cloud.n_owned(); ++node)
      kept_numbers.local_element(node) = kept[node];
    kept_numbers.update_ghost_values();
    return kept_numbers;
  }

  template <int dim>
  void
  NodeRelease<dim>::restore(const Vector &walls)
  {
    kept.resize(walls.locally_owned_size() +
                walls.get_partitioner()->n_ghost_indices());
    for (unsigned int node = 0; node < kept.size(); ++node)
      kept[node] = static_cast<unsigned int>(walls.local_element(node));
  }

  template <int dim>
  unsigned int
  NodeRelease<dim>::free_walls(const unsigned int node,
                               const Vector      &residual,
                               const double       force,
                               const System<dim> &system,
                               StepFields        &fields) const
  {
    unsigned int free = 0;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (((conditions.walls(node) & walls) >> w) & 1u)
        {
          const double       inwards = (w % 2 == 0) ? 1. : -1.;
          const unsigned int i       = system.displacement(node) + w / 2;
          if ((released[node] >> w) & 1u)
            {
              const bool back = inwards * fields.x.local_element(i) < 0.;
              if (!back || corrections >= corrections_both_ways)
                free |= 1u << w;
            }
          else if (inwards * residual.local_element(i) < -force)
            free |= 1u << w;
        }
    return free;
  }

  template <int dim>
  bool
  NodeRelease<dim>::correct(const Occupancy<dim> &occupancy,
                            const Vector         &residual,
                            const double          force,
                            System<dim>          &system,
                            StepFields           &fields)
  {
    if (corrections == most_corrections)
      return false;
    // Owners decide; a vector carries the sets to the halo.
    Vector             walls_of(system.cloud.partitioner());
    unsigned long long changed = 0;
    for (const unsigned int node : system.owned_nodes())
      {
        const bool may = (conditions.walls(node) & walls) != 0 &&
                         (occupancy.active[node] & phases) != 0;
        const unsigned int free =
          may ? free_walls(node, residual, force, system, fields) : 0;
        changed += free != released[node];
        walls_of.local_element(node) = free;
      }
    ++corrections;
    if (Utilities::MPI::sum(changed, residual.get_mpi_communicator()) == 0)
      return false;
    walls_of.update_ghost_values();
    const auto before = released;
    for (unsigned int node = 0; node < released.size(); ++node)
      released[node] = static_cast<unsigned int>(walls_of.local_element(node));
    apply(system.cloud);
    system.update_held();
    // Where a wall catches a node, the node has come to rest.
    for (const unsigned int node : system.owned_nodes())
      if ((before[node] & ~released[node]) != 0)
        for (unsigned int d = 0; d < dim; ++d)
          if (const unsigned int i = system.displacement(node) + d;
              system.held(i))
            for (Vector *field : {&fields.x, &fields.v_n, &fields.a_n})
              if (field->size() > 0)
                field->local_element(i) = 0.;
    for (Vector *field : {&fields.x, &fields.v_n, &fields.a_n})
      if (field->size() > 0)
        field->update_ghost_values();
    return true;
  }

  template <int dim>
  void
  NodeRelease<dim>::apply(const NodeCloud<dim> &cloud)
  {
    for (unsigned int node = 0; node < cloud.size(); ++node)
      if ((conditions.walls(node) & walls) != 0)
        conditions.release(node, released[node]);
  }

  template class NodeRelease<2>;
  template class NodeRelease<3>;
} // namespace selkie
