#include <selkie/transfer/transfer.h>

#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Of the particles in iteration order, which is the numbering of
    /// StepPoint::particle.
    using Properties = std::vector<ArrayView<const double>>;

    template <int dim>
    Properties
    properties_of(const ParticleSet<dim> &particles)
    {
      Properties properties;
      for (const auto &particle : particles.handler())
        properties.push_back(particle.get_properties());
      return properties;
    }

    /// Calls see(patch, q, its properties) for every material point of the
    /// patches that `selects` chooses.
    template <int dim, typename Select, typename See>
    void
    for_each_point(const SupportTable<dim> &table,
                   const Properties        &properties,
                   const Select            &selects,
                   const See               &see)
    {
      for (const auto &patch : table.patches)
        if (patch.matter && selects(patch))
          for (unsigned int q = 0; q < patch.n_points; ++q)
            see(patch,
                q,
                properties[table.points[patch.first_point + q].particle]);
    }

    constexpr auto all_patches = [](const auto &) { return true; };

    /// What a point gives to the nodes; the gradient with TPIC only.
    template <int dim>
    struct Motion
    {
      Tensor<1, dim> v, a;
      Tensor<2, dim> grad_v;
    };

    template <bool tpic, int dim>
    Motion<dim>
    motion_of(const ParticleColumns<dim>    &columns,
              const ArrayView<const double> &mine)
    {
      Motion<dim> motion;
      motion.v = columns.v(mine);
      motion.a = columns.a(mine);
      if constexpr (tpic)
        motion.grad_v = columns.grad_v(mine);
      return motion;
    }

    /// Takes away what the nodes give to the point.
    template <bool tpic, int dim>
    void
    subtract_nodes(const SupportTable<dim> &table,
                   const Patch<dim>        &patch,
                   const unsigned int       q,
                   const System<dim>       &system,
                   const StepFields        &fields,
                   Motion<dim>             &motion)
    {
      const double *N = table.N(patch, q);
      for (unsigned int k = 0; k < patch.n_nodes; ++k)
        {
          const unsigned int u =
            system.displacement(table.nodes[patch.first_node + k]);
          for (unsigned int d = 0; d < dim; ++d)
            {
              const double v_a = fields.v_n.local_element(u + d);
              motion.v[d] -= N[k] * v_a;
              motion.a[d] -= N[k] * fields.a_n.local_element(u + d);
              if constexpr (tpic)
                for (unsigned int e = 0; e < dim; ++e)
                  motion.grad_v[d][e] -= N[(e + 1) * patch.n_padded + k] * v_a;
            }
        }
    }

    /// Calls add(i, m N_a, v, a) for every node of a point and its unknowns i,
    /// v (with TPIC v + grad v (x_a - x)) and a being what the point gives it.
    template <bool tpic, int dim, typename Add>
    void
    spread(const SupportTable<dim> &table,
           const Patch<dim>        &patch,
           const unsigned int       q,
           const System<dim>       &system,
           const Motion<dim>       &motion,
           const Add               &add)
    {
      const auto   &point = table.points[patch.first_point + q];
      const double *N     = table.N(patch, q);
      for (unsigned int k = 0; k < patch.n_nodes; ++k)
        {
          const unsigned int node = table.nodes[patch.first_node + k];
          const unsigned int u    = system.displacement(node);
          const double       mN   = point.mass * N[k];
          Tensor<1, dim>     v    = motion.v;
          if constexpr (tpic)
            v += motion.grad_v * (system.cloud.position(node) - point.x);
          for (unsigned int d = 0; d < dim; ++d)
            add(u + d, mN, v[d], motion.a[d]);
        }
    }

    /// Sums of mass and momentum of the points, and of m a.
    template <bool tpic, int dim>
    void
    add_motion(const ParticleColumns<dim> &columns,
               const Properties           &properties,
               const SupportTable<dim>    &table,
               const System<dim>          &system,
               StepFields                 &fields)
    {
      const auto add = [&](const unsigned int i,
                           const double       mN,
                           const double       v,
                           const double       a) {
        fields.mass.local_element(i) += mN;
        fields.v_n.local_element(i) += mN * v;
        fields.a_n.local_element(i) += mN * a;
      };
      for_each_point(table,
                     properties,
                     all_patches,
                     [&](const Patch<dim>              &patch,
                         const unsigned int             q,
                         const ArrayView<const double> &mine) {
                       spread<tpic>(table,
                                    patch,
                                    q,
                                    system,
                                    motion_of<tpic>(columns, mine),
                                    add);
                     });
    }

    /// What the points have and the nodes do not give them, projected and added
    /// to the nodes' velocity and acceleration. Collective.
    template <bool tpic, int dim>
    void
    add_missed_motion(const ParticleColumns<dim> &columns,
                      const Properties           &properties,
                      const SupportTable<dim>    &table,
                      const System<dim>          &system,
                      StepFields                 &fields)
    {
      Vector v_missed, a_missed;
      for (auto *vector : {&v_missed, &a_missed})
        system.initialize(*vector);
      for (const auto *vector : {&fields.v_n, &fields.a_n})
        vector->update_ghost_values();
      const auto add = [&](const unsigned int i,
                           const double       mN,
                           const double       v,
                           const double       a) {
        v_missed.local_element(i) += mN * v;
        a_missed.local_element(i) += mN * a;
      };
      for_each_point(table,
                     properties,
                     all_patches,
                     [&](const Patch<dim>              &patch,
                         const unsigned int             q,
                         const ArrayView<const double> &mine) {
                       auto missed = motion_of<tpic>(columns, mine);
                       subtract_nodes<tpic>(
                         table, patch, q, system, fields, missed);
                       spread<tpic>(table, patch, q, system, missed, add);
                     });
      for (auto *vector : {&v_missed, &a_missed})
        vector->compress(VectorOperation::add);
      for (unsigned int i = 0; i < fields.mass.locally_owned_size(); ++i)
        {
          const double weight = fields.mass.local_element(i);
          fields.v_n.local_element(i) += v_missed.local_element(i) / weight;
          fields.a_n.local_element(i) += a_missed.local_element(i) / weight;
        }
    }

    /// Volume and V p of the points with a pressure, at the pressure unknowns
    /// of fields.mass and fields.x.
    template <int dim>
    void
    add_pressures(const ParticleSet<dim>  &particles,
                  const Properties        &properties,
                  const SupportTable<dim> &table,
                  const System<dim>       &system,
                  StepFields              &fields)
    {
      for_each_point(
        table,
        properties,
        [](const Patch<dim> &patch) { return patch.pressure; },
        [&](const Patch<dim>              &patch,
            const unsigned int             q,
            const ArrayView<const double> &mine) {
          const double volume = table.points[patch.first_point + q].volume;
          const double p_q    = particles.columns.pressure(mine);
          for (unsigned int k = 0; k < patch.n_nodes; ++k)
            {
              const unsigned int p =
                system.pressure(table.nodes[patch.first_node + k], patch.phase);
              const double VN = volume * table.N(patch, q)[k];
              fields.mass.local_element(p) += VN;
              fields.x.local_element(p) += VN * p_q;
            }
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
    recall_pressures(const System<dim>     &system,
                     const StoredPressures &stored_pressures,
                     StepFields            &fields)
    {
      for (const auto &[node, phase] : system.owned_pressures())
        {
          const unsigned int p = system.pressure(node, phase);
          if (fields.mass.size() > 0)
            fields.mass.local_element(p) = 0.;
          if (const double stored =
                stored_pressures.at(phase).local_element(node);
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
          const StoredPressures   &stored_pressures,
          const NodalState<dim>   *nodes,
          StepFields              &fields)
  {
    const bool  moves   = particles.scene.inertia.has_value();
    const auto &columns = particles.columns;
    const bool  tpic    = columns.grad_v.exists();
    Properties  properties;
    system.initialize(fields.x);
    if (moves)
      {
        properties = properties_of(particles);
        for (auto *vector : {&fields.mass, &fields.v_n, &fields.a_n})
          system.initialize(*vector);
        const auto add =
          tpic ? &add_motion<true, dim> : &add_motion<false, dim>;
        add(columns, properties, table, system, fields);
        if (particles.scene.has_pressure())
          add_pressures(particles, properties, table, system, fields);
        divide_by_weight(fields);
        if (nodes != nullptr)
          nodes->recall(system, fields);
      }
    prescribe(system, t_n, dt, moves, fields);
    if (moves && nodes == nullptr)
      for (unsigned int k = 1; k < particles.scene.transfer.order; ++k)
        {
          const auto add = tpic ? &add_missed_motion<true, dim>
                                : &add_missed_motion<false, dim>;
          add(columns, properties, table, system, fields);
          prescribe(system, t_n, dt, moves, fields);
        }
    if (particles.scene.has_pressure())
      recall_pressures(system, stored_pressures, fields);
    fields.x.update_ghost_values();
    if (moves)
      for (auto *vector : {&fields.mass, &fields.v_n, &fields.a_n})
        vector->update_ghost_values();
  }

  template <int dim>
  StoredPressures
  no_pressures(const Scene<dim> &scene, const NodeCloud<dim> &cloud)
  {
    StoredPressures pressures;
    for (const auto &body : scene.bodies)
      if (body.has_pressure && pressures.count(body.phase) == 0)
        {
          Vector &field = pressures[body.phase];
          field.reinit(cloud.partitioner());
          field = std::numeric_limits<double>::quiet_NaN();
          field.update_ghost_values();
        }
    return pressures;
  }

  template <int dim>
  void
  store_pressures(const System<dim> &system,
                  const StepFields  &fields,
                  StoredPressures   &stored_pressures)
  {
    for (auto &[phase, field] : stored_pressures)
      field = std::numeric_limits<double>::quiet_NaN();
    for (const auto &[node, phase] : system.owned_pressures())
      stored_pressures.at(phase).local_element(node) =
        fields.x.local_element(system.pressure(node, phase));
    for (auto &[phase, field] : stored_pressures)
      field.update_ghost_values();
  }

#define INSTANTIATE(dim)                                         \
  template void            project(const ParticleSet<dim> &,     \
                                   const SupportTable<dim> &,    \
                                   const System<dim> &,          \
                                   const double,                 \
                                   const double,                 \
                                   const StoredPressures &,      \
                                   const NodalState<dim> *,      \
                                   StepFields &);                \
  template StoredPressures no_pressures(const Scene<dim> &,      \
                                        const NodeCloud<dim> &); \
  template void            store_pressures(const System<dim> &,  \
                                           const StepFields &,   \
                                           StoredPressures &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
