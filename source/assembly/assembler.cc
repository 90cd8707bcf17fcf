#include <selkie/assembly/assembler.h>
#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/laws/kinematics.h>
#include <selkie/laws/newtonian_fluid.h>

#include <deal.II/base/mpi.h>

#include <Epetra_FECrsMatrix.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Newton must not turn a point inside out on its way.
    constexpr double smallest_det_f = 0.05;
  } // namespace

  template <int dim>
  Assembler<dim>::Assembler(const Terms &terms, System<dim> &system)
    : terms(terms)
    , system(system)
  {
    for (const auto &term : terms)
      {
        const TermNeeds n = term->needs();
        needs.kinematics |= n.kinematics;
        needs.velocity_gradient |= n.velocity_gradient;
        needs.acceleration |= n.acceleration;
        needs.increment |= n.increment;
      }
  }

  template <int dim>
  void
  Assembler<dim>::compute_nodal_kinematics(const Newmark    &newmark,
                                           const StepFields &fields)
  {
    if (velocity.get_partitioner() != system.partitioner())
      {
        system.initialize(velocity);
        system.initialize(acceleration);
      }
    const unsigned int n = fields.x.locally_owned_size() +
                           fields.x.get_partitioner()->n_ghost_indices();
    for (unsigned int i = 0; i < n; ++i)
      {
        const double du               = fields.x.local_element(i);
        const double v_n              = fields.v_n.local_element(i);
        const double a_n              = fields.a_n.local_element(i);
        velocity.local_element(i)     = newmark.velocity(du, v_n, a_n);
        acceleration.local_element(i) = newmark.acceleration(du, v_n, a_n);
      }
  }

  template <int dim>
  bool
  Assembler<dim>::prepare(const SupportTable<dim> &table,
                          const Patch<dim>        &patch,
                          const StepTime          &time,
                          const StepFields        &fields)
  {
    dense.reinit(patch);
    unknowns.resize(dense.n_components * patch.n_nodes);
    const bool want_v = needs.velocity_gradient && patch.fluid;
    for (unsigned int a = 0; a < dense.n_padded; ++a)
      {
        const bool         real = a < patch.n_nodes;
        const unsigned int node =
          real ? table.nodes[patch.first_node + a] : invalid_index;
        const unsigned int first = real ? system.displacement(node) : 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const unsigned int at = d * dense.n_padded + a;
            if (real)
              unknowns[d * patch.n_nodes + a] = first + d;
            dense.du[at] = real ? fields.x.local_element(first + d) : 0.;
            if (want_v)
              dense.velocity[at] =
                real ? velocity.local_element(first + d) : 0.;
            if (needs.acceleration)
              dense.acceleration[at] =
                real ? acceleration.local_element(first + d) : 0.;
          }
        if (patch.fluid)
          {
            const unsigned int p_at = real ? system.pressure(node) : 0;
            if (real)
              unknowns[dim * patch.n_nodes + a] = p_at;
            dense.p[a] = real ? fields.x.local_element(p_at) : 0.;
          }
      }

    state.patch = &patch;
    state.table = &table;
    state.time  = &time;
    state.h     = patch.cell->extent_in_direction(0);
    state.forms.assign(patch.n_points, PointForm<dim>());
    state.mean.gradient.clear();
    state.kinematics.resize(patch.n_points);
    state.acceleration.resize(needs.acceleration ? patch.n_points : 0);
    state.increment.resize(needs.increment ? patch.n_points : 0);
    for (unsigned int q = 0; q < patch.n_points; ++q)
      {
        const double *N = table.N(patch, q);
        const double *G = N + dense.n_padded;
        if (needs.acceleration && patch.matter)
          for (unsigned int d = 0; d < dim; ++d)
            state.acceleration[q][d] =
              dense.value(dense.acceleration.data() + d * dense.n_padded, N);
        if (needs.increment && (patch.matter || patch.surface))
          for (unsigned int d = 0; d < dim; ++d)
            state.increment[q][d] =
              dense.value(dense.du.data() + d * dense.n_padded, N);
        if (!patch.integration)
          continue;

        PointKinematics<dim> &kin   = state.kinematics[q];
        const StepPoint<dim> &point = state.point(q);
        const Tensor<2, dim>  f =
          unit_symmetric_tensor<dim>() + dense.gradient(dense.du, G);
        kin.det_f = determinant(f);
        if (!(kin.det_f > smallest_det_f))
          return false;
        const Tensor<2, dim> f_inv = invert(f);
        kin.f                      = extend(f);
        kin.f_inv                  = extend(f_inv);
        kin.J                      = point.J_n * kin.det_f;
        for (unsigned int j = 0; j < dim; ++j)
          for (unsigned int i = 0; i < 3; ++i)
            kin.c[j][i] = kin.f_inv[j][i];
        if (want_v)
          kin.l = extend(dense.gradient(dense.velocity, G) * f_inv, 0.);
        if (patch.fluid)
          kin.p = dense.value(dense.p.data(), N);
      }
    return true;
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
    const MPI_Comm comm = residual.get_mpi_communicator();
    fields.x.update_ghost_values();
    compute_nodal_kinematics(time.newmark, fields);
    residual = 0.;
    if (with_tangent)
      system.matrix() = 0.;

    std::string failure;
    for (const auto &patch : table.patches)
      try
        {
          if (!prepare(table, patch, time, fields))
            {
              std::ostringstream out;
              out << "a point of the cell at (" << patch.cell->center()
                  << ") is turned inside out (det f <= " << smallest_det_f
                  << ")";
              failure = out.str();
              break;
            }
          for (const auto &term : terms)
            if (term->acts_on(patch))
              term->add(state, with_tangent);
          dense.integrate_forces(state);
          scatter_residual(table, patch, residual);
          if (with_tangent && !patch.surface &&
              (patch.integration || needs.acceleration))
            {
              dense.integrate_block(state);
              scatter_tangent(table, patch, pressure_unit);
            }
        }
      catch (const NumericalFailure &error)
        {
          failure = error.what();
          break;
        }
    throw_on_all_ranks<InvertedPoint>(comm, failure);

    residual.compress(VectorOperation::add);
    Vector diagonal;
    if (with_tangent)
      {
        system.initialize(diagonal);
        system.matrix().compress(VectorOperation::add);
      }
    const NodeState nodes{fields.mass, acceleration, fields.x};
    for (const auto &term : terms)
      term->add_at_nodes(nodes,
                         time.newmark,
                         residual,
                         with_tangent ? &diagonal : nullptr);
    if (with_tangent)
      add_diagonal(diagonal);
  }

  template <int dim>
  void
  Assembler<dim>::add_diagonal(const Vector &diagonal)
  {
    int    *row_start, *column;
    double *values;
    auto   &matrix =
      const_cast<Epetra_CrsMatrix &>(system.matrix().trilinos_matrix());
    matrix.ExtractCrsDataPointers(row_start, column, values);
    for (unsigned int i = 0; i < diagonal.locally_owned_size(); ++i)
      if (diagonal.local_element(i) != 0.)
        for (int k = row_start[i]; k < row_start[i + 1]; ++k)
          if (column[k] == system.column(i))
            {
              values[k] += diagonal.local_element(i);
              break;
            }
  }

  template <int dim>
  typename Assembler<dim>::Powers
  Assembler<dim>::powers(const SupportTable<dim> &table,
                         const StepTime          &time,
                         StepFields              &fields)
  {
    Powers sum;
    if (!needs.velocity_gradient && !needs.increment)
      return sum;
    compute_nodal_kinematics(time.newmark, fields);
    for (const auto &patch : table.patches)
      if (prepare(table, patch, time, fields))
        for (const auto &term : terms)
          if (term->acts_on(patch))
            {
              sum.dissipation += term->dissipation(state);
              sum.external_work += term->external_work(state);
            }
    const MPI_Comm comm = fields.x.get_mpi_communicator();
    sum.dissipation     = Utilities::MPI::sum(sum.dissipation, comm);
    sum.external_work   = Utilities::MPI::sum(sum.external_work, comm);
    return sum;
  }

  template <int dim>
  void
  Assembler<dim>::scatter_residual(const SupportTable<dim> &,
                                   const Patch<dim> &patch,
                                   Vector           &residual) const
  {
    for (unsigned int c = 0; c < dense.n_components; ++c)
      for (unsigned int a = 0; a < patch.n_nodes; ++a)
        residual.local_element(unknowns[c * patch.n_nodes + a]) +=
          dense.force[c * dense.n_padded + a];
  }

  template <int dim>
  void
  Assembler<dim>::scatter_tangent(const SupportTable<dim> &,
                                  const Patch<dim> &patch,
                                  const double      pressure_unit)
  {
    int    *row_start, *column;
    double *values;
    auto   &matrix =
      const_cast<Epetra_CrsMatrix &>(system.matrix().trilinos_matrix());
    matrix.ExtractCrsDataPointers(row_start, column, values);
    const unsigned int n = patch.n_nodes, n_owned = system.n_owned();
    if (positions.size() < static_cast<unsigned int>(matrix.NumMyCols()))
      positions.resize(matrix.NumMyCols());

    for (unsigned int a = 0; a < n; ++a)
      for (unsigned int c = 0; c < dense.n_components; ++c)
        {
          const unsigned int row      = unknowns[c * n + a];
          const double      *block    = dense.row(a, c);
          const double       row_unit = c == dim ? pressure_unit : 1.;
          if (row >= n_owned)
            {
              add_row(row, patch, row_unit, pressure_unit, block);
              continue;
            }
          // Displacement rows of a node share their columns.
          if (c == 0 || c == dim)
            for (int k = row_start[row]; k < row_start[row + 1]; ++k)
              positions[column[k]] = k - row_start[row];
          double    *row_values = values + row_start[row];
          const bool row_held   = system.held(row);
          for (unsigned int k = 0; k < dense.n_components; ++k)
            {
              const double unit = row_unit * (k == dim ? pressure_unit : 1.);
              for (unsigned int b = 0; b < n; ++b)
                {
                  const unsigned int col = unknowns[k * n + b];
                  if ((row_held || system.held(col)) && row != col)
                    continue;
                  row_values[positions[system.column(col)]] +=
                    unit * block[k * dense.n_padded + b];
                }
            }
        }
  }

  template <int dim>
  void
  Assembler<dim>::add_row(const unsigned int row,
                          const Patch<dim>  &patch,
                          const double       row_unit,
                          const double       pressure_unit,
                          const double      *block)
  {
    const auto        &partition = *system.partitioner();
    const unsigned int n         = patch.n_nodes;
    global_columns.clear();
    row_values.clear();
    for (unsigned int k = 0; k < dense.n_components; ++k)
      for (unsigned int b = 0; b < n; ++b)
        {
          const unsigned int col = unknowns[k * n + b];
          if ((system.held(row) || system.held(col)) && row != col)
            continue;
          global_columns.push_back(partition.local_to_global(col));
          row_values.push_back(row_unit * (k == dim ? pressure_unit : 1.) *
                               block[k * dense.n_padded + b]);
        }
    system.matrix().add(partition.local_to_global(row),
                        global_columns.size(),
                        global_columns.data(),
                        row_values.data(),
                        false);
  }

  template class Assembler<2>;
  template class Assembler<3>;
} // namespace selkie
