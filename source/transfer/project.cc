#include <selkie/laws/newtonian_fluid.h>
#include <selkie/transfer/transfer.h>

#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The points' contributions to mass, momentum, m a, volume, V p.
    template <int dim>
    void
    add_points(const ParticleSet<dim>  &particles,
               const SupportTable<dim> &table,
               const System<dim>       &system,
               StepFields              &fields)
    {
      const auto                          &columns = particles.columns;
      std::vector<ArrayView<const double>> properties;
      properties.reserve(table.n_particles);
      for (const auto &particle : particles.handler())
        properties.push_back(particle.get_properties());

      for (const auto &patch : table.patches)
        if (patch.matter)
          for (unsigned int q = 0; q < patch.n_points; ++q)
            {
              const auto          &point = table.points[patch.first_point + q];
              const double         m     = point.mass;
              const auto           mine  = properties[point.particle];
              const bool           moves = columns.v.exists();
              const Tensor<1, dim> v =
                moves ? columns.v(mine) : Tensor<1, dim>();
              const Tensor<1, dim> a =
                moves ? columns.a(mine) : Tensor<1, dim>();
              const bool           tpic = columns.grad_v.exists();
              const Tensor<2, dim> grad_v =
                tpic ? columns.grad_v(mine) : Tensor<2, dim>();
              const double pV =
                patch.fluid ? point.volume * columns.pressure(mine) : 0.;

              const double *N = table.N(patch, q);
              for (unsigned int k = 0; k < patch.n_nodes; ++k)
                {
                  const unsigned int node = table.nodes[patch.first_node + k];
                  const unsigned int u    = system.displacement(node);
                  const double       mN   = m * N[k];
                  Tensor<1, dim>     v_k  = v;
                  if (tpic)
                    v_k += grad_v * (system.cloud.position(node) - point.x);
                  for (unsigned int d = 0; d < dim; ++d)
                    {
                      fields.mass.local_element(u + d) += mN;
                      fields.v_n.local_element(u + d) += mN * v_k[d];
                      fields.a_n.local_element(u + d) += mN * a[d];
                    }
                  if (patch.fluid)
                    {
                      const unsigned int p = system.pressure(node);
                      fields.mass.local_element(p) += point.volume * N[k];
                      fields.x.local_element(p) += pV * N[k];
                    }
                }
            }
    }

    /// Prescribed velocities replace the recovered ones; the increment is the
    /// trapezoidal rule's.
    template <int dim>
    void
    prescribe(const System<dim> &system,
              const double       t_n,
              const double       dt,
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
    for (auto *vector : {&fields.mass, &fields.v_n, &fields.a_n, &fields.x})
      system.initialize(*vector);
    add_points(particles, table, system, fields);
    for (auto *vector : {&fields.mass, &fields.v_n, &fields.a_n, &fields.x})
      vector->compress(VectorOperation::add);

    for (unsigned int i = 0; i < system.n_owned(); ++i)
      {
        const double weight = fields.mass.local_element(i);
        fields.v_n.local_element(i) /= weight;
        fields.a_n.local_element(i) /= weight;
        fields.x.local_element(i) /= weight;
      }
    for (const unsigned int node : system.owned_pressure_nodes())
      {
        fields.mass.local_element(system.pressure(node)) = 0.;
        const double p = stored_pressure.local_element(node);
        if (!std::isnan(p))
          fields.x.local_element(system.pressure(node)) = p;
      }
    if (nodes != nullptr)
      nodes->recall(system, fields);
    prescribe(system, t_n, dt, fields);
    for (auto *vector : {&fields.mass, &fields.v_n, &fields.a_n, &fields.x})
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

  template <int dim>
  void
  correct_volume(const FluidPressure &parameters,
                 const System<dim>   &system,
                 SupportTable<dim>   &table)
  {
    if (parameters.volume_kappa == 0.)
      return;
    const auto &cloud = system.cloud;
    Vector      theta(cloud.partitioner());
    for (const auto &patch : table.patches)
      if (patch.matter)
        for (unsigned int q = 0; q < patch.n_points; ++q)
          {
            const auto  &point = table.points[patch.first_point + q];
            const double volume =
              point.volume * (patch.fluid ? point.J_n : determinant(point.F_n));
            const double *N = table.N(patch, q);
            for (unsigned int k = 0; k < patch.n_nodes; ++k)
              theta.local_element(table.nodes[patch.first_node + k]) +=
                volume * N[k];
          }
    theta.compress(VectorOperation::add);
    for (unsigned int node = 0; node < cloud.n_owned(); ++node)
      theta.local_element(node) /= cloud.volume(node);
    theta.update_ghost_values();

    // Beside hanging nodes the node's share of its cells is not the volume
    // that LME functions give it: no correction there.
    for (const auto &patch : table.patches)
      if (patch.fluid &&
          cloud.equally_spaced(&table.nodes[patch.first_node], patch.n_nodes))
        for (unsigned int q = 0; q < patch.n_points; ++q)
          {
            const double *N       = table.N(patch, q);
            double        theta_q = 0.;
            for (unsigned int k = 0; k < patch.n_nodes; ++k)
              theta_q +=
                N[k] * theta.local_element(table.nodes[patch.first_node + k]);
            const double crowding =
              std::max(0., theta_q - 1. - parameters.volume_deadband);
            table.points[patch.first_point + q].J_n *=
              1. - parameters.volume_kappa * std::min(0.2, crowding);
          }
  }

#define INSTANTIATE(dim)                              \
  template void project(const ParticleSet<dim> &,     \
                        const SupportTable<dim> &,    \
                        const System<dim> &,          \
                        const double,                 \
                        const double,                 \
                        const Vector &,               \
                        const NodalState<dim> *,      \
                        StepFields &);                \
  template void store_pressure(const System<dim> &,   \
                               const StepFields &,    \
                               Vector &);             \
  template void correct_volume(const FluidPressure &, \
                               const System<dim> &,   \
                               SupportTable<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
