#include <selkie/base/collective_error.h>
#include <selkie/laws/volumetric_part.h>
#include <selkie/transfer/transfer.h>

#include <deal.II/base/mpi.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// What the nodes have at the end of the step, on the unknowns' numbering
    /// with ghosts; velocities with inertia only.
    struct NodalEnd
    {
      const Vector &du; ///< and pressures
      Vector        v, dv, a;

      NodalEnd(const StepFields &fields, const Newmark &newmark)
        : du(fields.x)
      {
        if (fields.v_n.size() == 0)
          return;
        for (Vector *field : {&v, &dv, &a})
          field->reinit(fields.x, true);
        const unsigned int n =
          du.locally_owned_size() + du.get_partitioner()->n_ghost_indices();
        for (unsigned int i = 0; i < n; ++i)
          {
            const double v_n    = fields.v_n.local_element(i);
            const double a_n    = fields.a_n.local_element(i);
            const double x      = du.local_element(i);
            v.local_element(i)  = newmark.velocity(x, v_n, a_n);
            dv.local_element(i) = v.local_element(i) - v_n;
            a.local_element(i)  = newmark.acceleration(x, v_n, a_n);
          }
        for (const Vector *field : {&v, &dv, &a})
          field->set_ghost_state(true); // computed, not sent
      }
    };

    /// @tparam moves with inertia
    /// @tparam tpic with velocity gradients
    template <bool moves, bool tpic, int dim>
    PointEnd<dim>
    interpolate(const SupportTable<dim> &table,
                const Patch<dim>        &patch,
                const unsigned int       q,
                const System<dim>       &system,
                const NodalEnd          &nodes)
    {
      PointEnd<dim> at;
      const double *N = table.N(patch, q);
      for (unsigned int k = 0; k < patch.n_nodes; ++k)
        {
          const unsigned int u =
            system.displacement(table.nodes[patch.first_node + k]);
          Tensor<1, dim> G;
          for (unsigned int d = 0; d < dim; ++d)
            G[d] = N[(d + 1) * patch.n_padded + k];
          for (unsigned int d = 0; d < dim; ++d)
            {
              const double du = nodes.du.local_element(u + d);
              at.du[d] += N[k] * du;
              at.grad_du[d] += du * G;
              if constexpr (moves)
                {
                  at.v[d] += N[k] * nodes.v.local_element(u + d);
                  at.dv[d] += N[k] * nodes.dv.local_element(u + d);
                  at.a[d] += N[k] * nodes.a.local_element(u + d);
                }
              if constexpr (tpic)
                at.grad_v[d] += nodes.v.local_element(u + d) * G;
            }
        }
      return at;
    }

    template <int dim>
    double
    interpolate_pressure(const SupportTable<dim> &table,
                         const Patch<dim>        &patch,
                         const unsigned int       q,
                         const System<dim>       &system,
                         const Vector            &x)
    {
      double p = 0.;
      for (unsigned int k = 0; k < patch.n_nodes; ++k)
        p += table.N(patch, q)[k] *
             x.local_element(
               system.pressure(table.nodes[patch.first_node + k], patch.phase));
      return p;
    }

    /// grad v of a fluid point nearly alone in its cell is noise: zero.
    constexpr unsigned int lone_points = 3;

    /// The end values of all material points, in iteration order. Throws
    /// NumericalFailure, on every rank, before anything is written: a pressure
    /// that the matter cannot have.
    template <int dim>
    std::vector<PointEnd<dim>>
    end_values(const ParticleColumns<dim> &columns,
               const SupportTable<dim>    &table,
               const System<dim>          &system,
               const NodalEnd             &nodes,
               const MPI_Comm              comm)
    {
      const auto interpolate_motion =
        !columns.v.exists()       ? &interpolate<false, false, dim>
        : columns.grad_v.exists() ? &interpolate<true, true, dim>
                                  : &interpolate<true, false, dim>;
      std::vector<PointEnd<dim>> values(table.n_particles);
      std::string                failure;
      for (const auto &patch : table.patches)
        if (patch.matter)
          for (unsigned int q = 0; q < patch.n_points; ++q)
            {
              const auto &point = table.points[patch.first_point + q];
              auto       &at    = values[point.particle];
              at = interpolate_motion(table, patch, q, system, nodes);
              if (!patch.pressure)
                continue;
              at.p = interpolate_pressure(table, patch, q, system, nodes.du);
              try
                {
                  at.J = volumetric_part(*point.law).J_of_pressure(at.p);
                }
              catch (const NumericalFailure &error)
                {
                  failure = error.what();
                }
            }
      throw_on_all_ranks<NumericalFailure>(comm, failure);
      return values;
    }

    /// Writes a point's new state, all but its position.
    template <int dim>
    void
    write_point(const ParticleColumns<dim> &columns,
                const StepPoint<dim>       &point,
                const PointEnd<dim>        &at,
                const PatchKind            &kind,
                const bool                  alone,
                const double                flip,
                const Scene<dim>           &scene,
                const ArrayView<double>    &mine)
    {
      const Tensor<2, dim> f = unit_symmetric_tensor<dim>() + at.grad_du;
      if (columns.lambda.exists())
        columns.lambda.set(mine, point.lambda);
      if (columns.v.exists())
        {
          if (scene.lagrangian_mesh())
            columns.v.set(mine, at.v);
          else if (columns.grad_v.exists())
            {
              columns.v.set(mine, at.v);
              columns.grad_v.set(mine,
                                 alone ? Tensor<2, dim>()
                                       : at.grad_v * invert(f));
            }
          else
            columns.v.set(mine,
                          flip * (columns.v(mine) + at.dv) +
                            (1. - flip) * at.v);
          columns.a.set(mine, at.a);
        }
      if (kind.fluid)
        columns.J.set(mine, at.J);
      if (kind.pressure)
        columns.pressure.set(mine, at.p);
      if (!kind.fluid || scene.lagrangian_mesh())
        columns.F.set(mine, f * point.F_n);
      if (scene.mixed_solids && !kind.fluid) // what the law sees as J
        columns.mean_J.set(mine,
                           kind.pressure ? at.J : determinant(columns.F(mine)));
    }

    /// The volume ratio of a solid's patch at the end of the step.
    template <int dim>
    double
    mean_volume_ratio(const SupportTable<dim>          &table,
                      const Patch<dim>                 &patch,
                      const std::vector<PointEnd<dim>> &values)
    {
      double V_0 = 0., V = 0.;
      for (unsigned int q = 0; q < patch.n_points; ++q)
        {
          const auto          &point = table.points[patch.first_point + q];
          const Tensor<2, dim> f =
            unit_symmetric_tensor<dim>() + values[point.particle].grad_du;
          V_0 += point.volume;
          V += point.volume * determinant(Tensor<2, dim>(f * point.F_n));
        }
      return V / V_0;
    }
  } // namespace

  template <int dim>
  PointUpdate<dim>::PointUpdate(ParticleSet<dim>        &particles,
                                const SupportTable<dim> &table,
                                const System<dim>       &system,
                                const Newmark           &newmark,
                                const StepFields        &fields)
    : particles(particles)
    , table(table)
    , flip(particles.scene.transfer.flip_share(newmark.dt))
    , values(end_values(particles.columns,
                        table,
                        system,
                        NodalEnd(fields, newmark),
                        particles.communicator()))
  {
    displacements.reserve(values.size());
    for (const auto &at : values)
      displacements.push_back(at.du);
    particles.check_move(displacements); // from here on nothing fails
  }

  template <int dim>
  double
  PointUpdate<dim>::write_to(const Properties &properties) const
  {
    double reset_energy = 0.;
    for (const auto &patch : table.patches)
      if (patch.matter)
        for (unsigned int q = 0; q < patch.n_points; ++q)
          {
            const auto &point = table.points[patch.first_point + q];
            const auto &at    = values[point.particle];
            write_point(particles.columns,
                        point,
                        at,
                        patch,
                        patch.fluid && patch.n_points < lone_points,
                        flip,
                        particles.scene,
                        properties[point.particle]);
            // In full cells the Gauss points hold the energy.
            if (patch.fluid && patch.integration)
              {
                const auto  &law = static_cast<const FluidLaw &>(*point.law);
                const double moved =
                  point.J_n * determinant(Tensor<2, dim>(
                                unit_symmetric_tensor<dim>() + at.grad_du));
                reset_energy +=
                  point.volume * (law.energy(at.J) - law.energy(moved));
              }
          }
    if (particles.columns.mean_J.exists() && !particles.scene.mixed_solids)
      write_mean_J(properties);
    return reset_energy;
  }

  template <int dim>
  void
  PointUpdate<dim>::write_mean_J(const Properties &properties) const
  {
    for (const auto &patch : table.patches)
      if (patch.matter && !patch.fluid)
        {
          const double mean_J = mean_volume_ratio(table, patch, values);
          for (unsigned int q = 0; q < patch.n_points; ++q)
            particles.columns.mean_J.set(
              properties[table.points[patch.first_point + q].particle], mean_J);
        }
  }

  template <int dim>
  double
  PointUpdate<dim>::write()
  {
    Properties properties;
    properties.reserve(table.n_particles);
    for (auto &particle : particles.handler())
      properties.push_back(particle.get_properties());
    const double reset_energy =
      Utilities::MPI::sum(write_to(properties), particles.communicator());
    particles.move(displacements);
    return reset_energy;
  }

  template <int dim>
  void
  PointUpdate<dim>::preview(
    const std::function<void(const Point<dim> &,
                             const ArrayView<const double> &)> &see) const
  {
    const unsigned int  n = particles.fields.n_components();
    std::vector<double> scratch;
    scratch.reserve(n * table.n_particles);
    for (const auto &particle : particles.handler())
      for (const double value : particle.get_properties())
        scratch.push_back(value);
    Properties properties;
    for (unsigned int i = 0; i < table.n_particles; ++i)
      properties.emplace_back(scratch.data() + i * n, n);
    write_to(properties);
    unsigned int i = 0;
    for (const auto &particle : particles.handler())
      {
        see(particle.get_location() + displacements[i], properties[i]);
        ++i;
      }
  }

  template <int dim>
  void
  set_accelerations(ParticleSet<dim>        &particles,
                    const SupportTable<dim> &table,
                    const System<dim>       &system,
                    const Vector            &a)
  {
    std::vector<ArrayView<double>> properties;
    for (auto &particle : particles.handler())
      properties.push_back(particle.get_properties());
    for (const auto &patch : table.patches)
      if (patch.matter)
        for (unsigned int q = 0; q < patch.n_points; ++q)
          {
            Tensor<1, dim> a_q;
            for (unsigned int k = 0; k < patch.n_nodes; ++k)
              for (unsigned int d = 0; d < dim; ++d)
                a_q[d] +=
                  table.N(patch, q)[k] *
                  a.local_element(
                    system.displacement(table.nodes[patch.first_node + k]) + d);
            particles.columns.a.set(
              properties[table.points[patch.first_point + q].particle], a_q);
          }
  }

  template void
  set_accelerations(ParticleSet<2> &,
                    const SupportTable<2> &,
                    const System<2> &,
                    const Vector &);
  template void
  set_accelerations(ParticleSet<3> &,
                    const SupportTable<3> &,
                    const System<3> &,
                    const Vector &);
  template class PointUpdate<2>;
  template class PointUpdate<3>;
} // namespace selkie
