#include <selkie/transfer/transfer.h>

#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The properties of the particles in iteration order, which is the
    /// numbering of StepPoint::particle.
    template <int dim>
    std::vector<ArrayView<const double>>
    properties_of(const ParticleSet<dim> &particles)
    {
      std::vector<ArrayView<const double>> properties;
      for (const auto &particle : particles.handler())
        properties.push_back(particle.get_properties());
      return properties;
    }

    /// Calls add(point, its properties, N_a, node a) for every material point
    /// and node of the patches that `selects` chooses.
    template <int dim, typename Select, typename Add>
    void
    for_each_pair(const SupportTable<dim> &table,
                  const ParticleSet<dim>  &particles,
                  const Select            &selects,
                  const Add               &add)
    {
      const auto properties = properties_of(particles);
      for (const auto &patch : table.patches)
        if (patch.matter && selects(patch))
          for (unsigned int q = 0; q < patch.n_points; ++q)
            {
              const auto   &point = table.points[patch.first_point + q];
              const double *N     = table.N(patch, q);
              for (unsigned int k = 0; k < patch.n_nodes; ++k)
                add(point,
                    properties[point.particle],
                    N[k],
                    table.nodes[patch.first_node + k]);
            }
    }

    /// Mass and momentum of the points, and m a; with TPIC the velocity at the
    /// node is v + grad v (x_a - x).
    template <bool tpic, int dim>
    void
    add_motion(const ParticleSet<dim>  &particles,
               const SupportTable<dim> &table,
               const System<dim>       &system,
               StepFields              &fields)
    {
      const auto &columns = particles.columns;
      for_each_pair(
        table,
        particles,
        [](const Patch<dim> &) { return true; },
        [&](const StepPoint<dim>          &point,
            const ArrayView<const double> &mine,
            const double                   N,
            const unsigned int             node) {
          const unsigned int   u  = system.displacement(node);
          const double         mN = point.mass * N;
          const Tensor<1, dim> a  = columns.a(mine);
          Tensor<1, dim>       v  = columns.v(mine);
          if constexpr (tpic)
            v += columns.grad_v(mine) * (system.cloud.position(node) - point.x);
          for (unsigned int d = 0; d < dim; ++d)
            {
              fields.mass.local_element(u + d) += mN;
              fields.v_n.local_element(u + d) += mN * v[d];
              fields.a_n.local_element(u + d) += mN * a[d];
            }
        });
    }

    /// Volume and V p of the points with a pressure, at the pressure unknowns
    /// of fields.mass and fields.x.
    template <int dim>
    void
    add_pressures(const ParticleSet<dim>  &particles,
                  const SupportTable<dim> &table,
                  const System<dim>       &system,
                  StepFields              &fields)
    {
      const auto &columns = particles.columns;
      for_each_pair(
        table,
        particles,
        [phases = particles.scene.pressure_phases()](const Patch<dim> &patch) {
          return ((phases >> patch.phase) & 1u) != 0;
        },
        [&](const StepPoint<dim>          &point,
            const ArrayView<const double> &mine,
            const double                   N,
            const unsigned int             node) {
          const unsigned int p  = system.pressure(node);
          const double       VN = point.volume * N;
          fields.mass.local_element(p) += VN;
          fields.x.local_element(p) += VN * columns.pressure(mine);
        });
    }

    /// Sums become means.
    void
    divide_by_weight(StepFields &fields)
    {
      for (auto *vector : {&fields.mass, &fields.v_n, &fields.a_n, &fields.x})
        vector->compress(VectorOperation::add);
      for (unsigned int i = 0; i < fields.mass.locally_owned_size(); ++i)
        {
          const double weight = fields.mass.local_element(i);
          fields.v_n.local_element(i) /= weight;
          fields.a_n.local_element(i) /= weight;
          fields.x.local_element(i) /= weight;
        }
    }

    /// The nodes' pressures of the last step, where there are any, replace
    /// those of the points; pressures have no mass.
    template <int dim>
    void
    recall_pressures(const System<dim> &system,
                     const Vector      &stored_pressure,
                     StepFields        &fields)
    {
      for (const unsigned int node : system.owned_pressure_nodes())
        {
          const unsigned int p = system.pressure(node);
          if (fields.mass.size() > 0)
            fields.mass.local_element(p) = 0.;
          if (const double stored = stored_pressure.local_element(node);
              !std::isnan(stored))
            fields.x.local_element(p) = stored;
        }
    }

    /// Held nodes move with the prescribed velocity, by the trapezoidal rule;
    /// with inertia, theirs replace the recovered velocities.
    template <int dim>
    void
    prescribe(const System<dim> &system,
              const double       t_n,
              const double       dt,
              const bool         moves,
              StepFields        &fields)
    {
      for (const unsigned int node : system.owned_nodes())
        if (system.conditions.held(node) != 0)
          {
            const unsigned int   u  = system.displacement(node);
            const Tensor<1, dim> v0 = system.conditions.velocity(node, t_n);
            const Tensor<1, dim> v1 =
              system.conditions.velocity(node, t_n + dt);
            for (unsigned int d = 0; d < dim; ++d)
              if (system.held(u + d))
                {
                  fields.x.local_element(u + d) = 0.5 * dt * (v0[d] + v1[d]);
                  if (!moves)
                    continue;
                  fields.v_n.local_element(u + d) = v0[d];
                  fields.a_n.local_element(u + d) = (v1[d] - v0[d]) / dt;
                }
          }
    }
  } // namespace

  template <int dim>
  void
  project(const ParticleSet<dim>  &particles,
          const SupportTable<dim> &table,
          const System<dim>       &system,
          const double             t_n,
          const double             dt,
          const Vector            &stored_pressure,
          const NodalState<dim>   *nodes,
          StepFields              &fields)
  {
    const bool moves = particles.scene.inertia.has_value();
    system.initialize(fields.x);
    if (moves)
      {
        for (auto *vector : {&fields.mass, &fields.v_n, &fields.a_n})
          system.initialize(*vector);
        if (particles.columns.grad_v.exists())
          add_motion<true>(particles, table, system, fields);
        else
          add_motion<false>(particles, table, system, fields);
        if (particles.scene.has_pressure())
          add_pressures(particles, table, system, fields);
        divide_by_weight(fields);
        if (nodes != nullptr)
          nodes->recall(system, fields);
      }
    if (particles.scene.has_pressure())
      recall_pressures(system, stored_pressure, fields);
    prescribe(system, t_n, dt, moves, fields);
    fields.x.update_ghost_values();
    if (moves)
      for (auto *vector : {&fields.mass, &fields.v_n, &fields.a_n})
        vector->update_ghost_values();
  }

  template <int dim>
  void
  store_pressure(const System<dim> &system,
                 const StepFields  &fields,
                 Vector            &stored_pressure)
  {
    stored_pressure = std::numeric_limits<double>::quiet_NaN();
    for (const unsigned int node : system.owned_pressure_nodes())
      stored_pressure.local_element(node) =
        fields.x.local_element(system.pressure(node));
    stored_pressure.update_ghost_values();
  }

#define INSTANTIATE(dim)                            \
  template void project(const ParticleSet<dim> &,   \
                        const SupportTable<dim> &,  \
                        const System<dim> &,        \
                        const double,               \
                        const double,               \
                        const Vector &,             \
                        const NodalState<dim> *,    \
                        StepFields &);              \
  template void store_pressure(const System<dim> &, \
                               const StepFields &,  \
                               Vector &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
