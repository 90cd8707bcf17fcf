#include <selkie/assembly/assembler.h>
#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/laws/kinematics.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <sstream>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Newton must not turn a point inside out on its way.
    constexpr double smallest_det_f = 0.05;

    /// Parts of the cost ledger that belong to all terms, before the terms.
    enum SharedPart : unsigned int
    {
      gathering,
      integration,
      scattering,
      hat_matrix,
      first_term
    };

    template <int dim>
    std::vector<std::string>
    ledger_parts(const std::vector<std::shared_ptr<const Term<dim>>> &terms)
    {
      std::vector<std::string> parts = {"gather and kinematics",
                                        "block of the patch",
                                        "scatter",
                                        "hat functions"};
      for (const auto &term : terms)
        parts.push_back(term->name());
      return parts;
    }
  } // namespace

  template <int dim>
  Assembler<dim>::Assembler(const Terms &terms, System<dim> &system)
    : terms(terms)
    , system(system)
    , ledger(ledger_parts<dim>(terms))
    , tangent(system)
    , hat_tangent(system)
  {
    for (const auto &term : terms)
      {
        use |= term->use();
        if (term->use().at_nodes)
          node_terms.push_back(term.get());
      }
    for (unsigned int bits = 0; bits < PatchKind::n_kinds; ++bits)
      {
        const PatchKind kind{bool(bits & 1),
                             bool(bits & 2),
                             bool(bits & 4),
                             bool(bits & 8),
                             bool(bits & 16),
                             bool(bits & 32)};
        kernels[kind.index()]        = compose(kind, false);
        energy_kernels[kind.index()] = compose(kind, true);
      }
  }

  /// The kernel of a kind of patch: for the residual and the tangent, or for
  /// the terms' energies.
  template <int dim>
  typename Assembler<dim>::Kernel
  Assembler<dim>::compose(const PatchKind &kind, const bool for_energy) const
  {
    Kernel  kernel;
    TermUse used;
    for (unsigned int i = 0; i < terms.size(); ++i)
      if (terms[i]->acts_on(kind) && (!for_energy || terms[i]->use().energy))
        {
          kernel.terms.push_back(i);
          used |= terms[i]->use();
        }
    used.increment = used.increment || for_energy;
    if (kernel.terms.empty())
      return kernel;
    kernel.prepare       = preparations(used);
    kernel.forces        = DensePatch<dim>::force_steps(used);
    kernel.block         = DensePatch<dim>::block_steps(used);
    kernel.with_pressure = used.volume;
    kernel.with_mass     = used.mass;
    return kernel;
  }

  template <int dim>
  std::vector<typename Assembler<dim>::Preparation>
  Assembler<dim>::preparations(const TermUse &used)
  {
    std::vector<Preparation> steps;
    const auto add_if = [&steps](const bool needed, const Preparation step) {
      if (needed)
        steps.push_back(step);
    };
    add_if(used.kinematics || used.increment, &Assembler::gather_increments);
    add_if(used.velocity_gradient || used.velocity,
           &Assembler::gather_velocities);
    add_if(used.acceleration, &Assembler::gather_accelerations);
    add_if(used.pressure, &Assembler::gather_pressures);
    add_if(used.kinematics, &Assembler::point_kinematics);
    add_if(used.velocity_gradient, &Assembler::point_velocity_gradients);
    add_if(used.pressure, &Assembler::point_pressures);
    add_if(used.velocity, &Assembler::point_velocities);
    add_if(used.acceleration, &Assembler::point_accelerations);
    add_if(used.increment, &Assembler::point_increments);
    return steps;
  }

  // --- the steps of a kernel -------------------------------------------------

  /// Nodal values of a displacement-like field, padded with zeros.
  template <int dim>
  void
  Assembler<dim>::gather(const Patch<dim>      &patch,
                         const Vector          &from,
                         AlignedVector<double> &values) const
  {
    const unsigned int n = patch.n_nodes;
    for (unsigned int d = 0; d < dim; ++d)
      {
        double *to = values.data() + d * dense.n_padded;
        for (unsigned int a = 0; a < n; ++a)
          to[a] = from.local_element(unknowns[d * n + a]);
        std::fill(to + n, to + dense.n_padded, 0.);
      }
  }

  /// sum_a N_a values_a at the points.
  template <int dim>
  std::vector<Tensor<1, dim>>
  Assembler<dim>::interpolate(const Patch<dim>            &patch,
                              const AlignedVector<double> &values) const
  {
    std::vector<Tensor<1, dim>> result(patch.n_points);
    for (unsigned int q = 0; q < patch.n_points; ++q)
      for (unsigned int d = 0; d < dim; ++d)
        result[q][d] = dense.value(values.data() + d * dense.n_padded,
                                   state.table->N(patch, q));
    return result;
  }

  template <int dim>
  bool
  Assembler<dim>::gather_increments(const Patch<dim> &patch)
  {
    gather(patch, iterate->x, dense.du);
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::gather_velocities(const Patch<dim> &patch)
  {
    gather(patch, velocity, dense.velocity);
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::gather_accelerations(const Patch<dim> &patch)
  {
    gather(patch, acceleration, dense.acceleration);
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::gather_pressures(const Patch<dim> &patch)
  {
    const unsigned int n = patch.n_nodes;
    for (unsigned int a = 0; a < n; ++a)
      dense.p[a] = iterate->x.local_element(unknowns[dim * n + a]);
    std::fill(dense.p.data() + n, dense.p.data() + dense.n_padded, 0.);
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::point_kinematics(const Patch<dim> &patch)
  {
    for (unsigned int q = 0; q < patch.n_points; ++q)
      {
        PointKinematics<dim> &kin = state.kinematics[q];
        const double         *G   = state.table->N(patch, q) + dense.n_padded;
        const Tensor<2, dim>  f =
          unit_symmetric_tensor<dim>() + dense.gradient(dense.du, G);
        kin.det_f = determinant(f);
        if (!(kin.det_f > smallest_det_f))
          return false;
        kin.f     = extend(f);
        kin.f_inv = extend(Tensor<2, dim>(invert(f)));
        kin.J     = state.point(q).J_n * kin.det_f;
        for (unsigned int j = 0; j < dim; ++j)
          for (unsigned int i = 0; i < 3; ++i)
            kin.c[j][i] = kin.f_inv[j][i];
      }
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::point_velocity_gradients(const Patch<dim> &patch)
  {
    for (unsigned int q = 0; q < patch.n_points; ++q)
      {
        const double *G       = state.table->N(patch, q) + dense.n_padded;
        state.kinematics[q].l = extend(dense.gradient(dense.velocity, G), 0.) *
                                state.kinematics[q].f_inv;
      }
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::point_pressures(const Patch<dim> &patch)
  {
    for (unsigned int q = 0; q < patch.n_points; ++q)
      state.kinematics[q].p =
        dense.value(dense.p.data(), state.table->N(patch, q));
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::point_velocities(const Patch<dim> &patch)
  {
    state.velocity = interpolate(patch, dense.velocity);
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::point_accelerations(const Patch<dim> &patch)
  {
    state.acceleration = interpolate(patch, dense.acceleration);
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::point_increments(const Patch<dim> &patch)
  {
    state.increment = interpolate(patch, dense.du);
    return true;
  }

  // --- the loop --------------------------------------------------------------

  /// Points the scratch at a step, and computes the nodal fields that the
  /// terms ask for (terms that do come with inertia).
  template <int dim>
  void
  Assembler<dim>::begin(const SupportTable<dim> &table,
                        const StepTime          &time,
                        StepFields              &fields)
  {
    state.table = &table;
    state.time  = &time;
    iterate     = &fields;

    const unsigned int n = fields.x.locally_owned_size() +
                           fields.x.get_partitioner()->n_ghost_indices();
    const auto update = [&](Vector &field, const auto &newmark_rule) {
      if (field.get_partitioner() != system.partitioner())
        system.initialize(field);
      for (unsigned int i = 0; i < n; ++i)
        field.local_element(i) = newmark_rule(fields.x.local_element(i),
                                              fields.v_n.local_element(i),
                                              fields.a_n.local_element(i));
      field.set_ghost_state(true); // computed, not sent
    };
    if (use.velocity_gradient || use.velocity)
      update(velocity, [&](const double du, const double v, const double a) {
        return time.newmark.velocity(du, v, a);
      });
    if (use.acceleration || use.at_nodes)
      update(acceleration,
             [&](const double du, const double v, const double a) {
               return time.newmark.acceleration(du, v, a);
             });
  }

  template <int dim>
  void
  Assembler<dim>::number_unknowns(const unsigned int        *nodes,
                                  const unsigned int         phase,
                                  const DensePatch<dim>     &dense,
                                  std::vector<unsigned int> &unknowns) const
  {
    const unsigned int n = dense.n_nodes;
    unknowns.resize(dense.n_components * n);
    for (unsigned int a = 0; a < n; ++a)
      {
        for (unsigned int d = 0; d < dim; ++d)
          unknowns[d * n + a] = system.displacement(nodes[a]) + d;
        if (dense.n_components > dim)
          unknowns[dim * n + a] = system.pressure(nodes[a], phase);
      }
  }

  /// Everything that the terms of the patch read. False if a point of it is
  /// inverted.
  template <int dim>
  bool
  Assembler<dim>::prepare(const Kernel &kernel, const Patch<dim> &patch)
  {
    dense.reinit(patch, kernel.with_pressure);
    number_unknowns(state.table->nodes.data() + patch.first_node,
                    patch.phase,
                    dense,
                    unknowns);
    state.patch = &patch;
    state.forms.assign(patch.n_points, PointForm<dim>());
    state.kinematics.resize(patch.n_points);
    for (const Preparation step : kernel.prepare)
      if (!(this->*step)(patch))
        return false;
    return true;
  }

  template <int dim>
  bool
  Assembler<dim>::add_patch(const Kernel     &kernel,
                            const Patch<dim> &patch,
                            const bool        with_tangent,
                            Vector           &residual)
  {
    const bool sampled = ledger.begin_pass();
    const auto book    = [&](const unsigned int part) {
      if (sampled)
        ledger.book(part);
    };
    if (!prepare(kernel, patch))
      return false;
    book(gathering);
    for (const unsigned int i : kernel.terms)
      {
        terms[i]->add(state, with_tangent);
        book(first_term + i);
      }
    for (const auto step : kernel.forces)
      (dense.*step)(state);
    const bool as_block = with_tangent && !system.points();
    if (as_block)
      for (const auto step : kernel.block)
        (dense.*step)(state);
    book(integration);
    scatter_residual(patch, residual);
    if (as_block && !kernel.block.empty())
      tangent.add(unknowns, dense);
    else if (with_tangent && !kernel.block.empty())
      system.points()->add(unknowns,
                           state,
                           kernel.with_mass,
                           kernel.with_pressure);
    book(scattering);
    if (with_tangent && !kernel.block.empty() && system.hats())
      {
        add_hats(kernel);
        book(hat_matrix);
      }
    return true;
  }

  /// The forms of the present patch with the hat functions of its cell.
  template <int dim>
  void
  Assembler<dim>::add_hats(const Kernel &kernel)
  {
    const PatchState<dim> &hats = hat_patch.of(state, system.cloud);
    hat_dense.reinit(*hats.patch, kernel.with_pressure);
    number_unknowns(hats.table->nodes.data() + hats.patch->first_node,
                    hats.patch->phase,
                    hat_dense,
                    hat_unknowns);
    for (const auto step : kernel.block)
      (hat_dense.*step)(hats);
    hat_tangent.add(hat_unknowns, hat_dense);
  }

  template <int dim>
  void
  Assembler<dim>::assemble(const SupportTable<dim> &table,
                           const StepTime          &time,
                           StepFields              &fields,
                           const double             pressure_unit,
                           const bool               with_tangent,
                           Vector                  &residual)
  {
    fields.x.update_ghost_values();
    begin(table, time, fields);
    residual = 0.;
    PointTangent<dim, double> *points =
      with_tangent ? system.points() : nullptr;
    if (points)
      points->begin(system, table, pressure_unit);
    else if (with_tangent)
      {
        system.want_matrix(table);
        tangent.begin(system.matrix(), pressure_unit);
      }
    const bool with_hats = with_tangent && system.hats();
    if (with_hats)
      hat_tangent.begin(*system.hats(), pressure_unit);

    std::string failure;
    for (const auto &patch : table.patches)
      try
        {
          const Kernel &kernel = kernels[patch.index()];
          if (!kernel.terms.empty() &&
              !add_patch(kernel, patch, with_tangent, residual))
            {
              std::ostringstream out;
              out << "a point of the cell at (" << patch.cell->center()
                  << ") is turned inside out (det f <= " << smallest_det_f
                  << ")";
              failure = out.str();
              break;
            }
        }
      catch (const NumericalFailure &error)
        {
          failure = error.what();
          break;
        }
    throw_on_all_ranks<InvertedPoint>(residual.get_mpi_communicator(), failure);

    residual.compress(VectorOperation::add);
    if (points)
      points->finish();
    else if (with_tangent)
      tangent.finish();
    if (with_hats)
      hat_tangent.finish();
    if (!node_terms.empty())
      add_at_nodes(time, fields, with_tangent, residual);
  }

  template <int dim>
  void
  Assembler<dim>::add_at_nodes(const StepTime   &time,
                               const StepFields &fields,
                               const bool        with_tangent,
                               Vector           &residual)
  {
    const NodeState nodes{fields.mass, acceleration};
    Vector          diagonal;
    if (with_tangent)
      system.initialize(diagonal);
    for (const Term<dim> *term : node_terms)
      term->add_at_nodes(nodes,
                         time.newmark,
                         residual,
                         with_tangent ? &diagonal : nullptr);
    if (with_tangent && system.points())
      system.points()->add_diagonal(diagonal);
    else if (with_tangent)
      tangent.add_diagonal(diagonal);
    if (with_tangent && system.hats())
      hat_tangent.add_diagonal(diagonal);
  }

  template <int dim>
  typename Assembler<dim>::Powers
  Assembler<dim>::powers(const SupportTable<dim> &table,
                         const StepTime          &time,
                         StepFields              &fields)
  {
    Powers sum;
    if (!use.energy)
      return sum;
    fields.x.update_ghost_values();
    begin(table, time, fields);
    for (const auto &patch : table.patches)
      {
        const Kernel &kernel = energy_kernels[patch.index()];
        if (!kernel.terms.empty() && prepare(kernel, patch))
          for (const unsigned int i : kernel.terms)
            {
              sum.dissipation += terms[i]->dissipation(state);
              sum.external_work += terms[i]->external_work(state);
            }
      }
    const MPI_Comm comm = fields.x.get_mpi_communicator();
    sum.dissipation     = Utilities::MPI::sum(sum.dissipation, comm);
    sum.external_work   = Utilities::MPI::sum(sum.external_work, comm);
    return sum;
  }

  template <int dim>
  void
  Assembler<dim>::scatter_residual(const Patch<dim> &patch,
                                   Vector           &residual) const
  {
    for (unsigned int c = 0; c < dense.n_components; ++c)
      for (unsigned int a = 0; a < patch.n_nodes; ++a)
        residual.local_element(unknowns[c * patch.n_nodes + a]) +=
          dense.force[c * dense.n_padded + a];
  }

  template class Assembler<2>;
  template class Assembler<3>;
} // namespace selkie
