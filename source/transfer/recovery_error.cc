#include <selkie/transfer/recovery_error.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Value and gradient of the nodes' field at a point.
    template <int dim>
    std::pair<Tensor<1, dim>, Tensor<2, dim>>
    field_at(const SupportTable<dim> &table,
             const Patch<dim>        &patch,
             const unsigned int       q,
             const System<dim>       &system,
             const Vector            &field)
    {
      Tensor<1, dim> v;
      Tensor<2, dim> grad;
      const double  *N = table.N(patch, q);
      for (unsigned int k = 0; k < patch.n_nodes; ++k)
        {
          const unsigned int u =
            system.displacement(table.nodes[patch.first_node + k]);
          for (unsigned int i = 0; i < dim; ++i)
            {
              const double value = field.local_element(u + i);
              v[i] += N[k] * value;
              for (unsigned int j = 0; j < dim; ++j)
                grad[i][j] += N[(j + 1) * patch.n_padded + k] * value;
            }
        }
      return {v, grad};
    }

    /// Calls what(patch, point, its index in the patch) for all material
    /// points.
    template <int dim, typename What>
    void
    for_each_point(const SupportTable<dim> &table, const What &what)
    {
      for (const auto &patch : table.patches)
        if (patch.matter)
          for (unsigned int q = 0; q < patch.n_points; ++q)
            what(patch, table.points[patch.first_point + q], q);
    }
  } // namespace


  template <int dim>
  RecoveryError
  recovery_error(const SupportTable<dim> &table,
                 const System<dim>       &system,
                 const Newmark           &newmark,
                 const StepFields        &fields)
  {
    Vector field(fields.x), volume;
    system.initialize(volume);
    field.zero_out_ghost_values();
    for (unsigned int i = 0; i < system.n_owned_displacements(); ++i)
      field.local_element(i) = fields.v_n.size() == 0
                                 ? fields.x.local_element(i)
                                 : fields.velocity(newmark, i);
    field.update_ghost_values();

    // G_a by columns: gradient[j] holds the derivatives along axis j.
    std::array<Vector, dim> gradient;
    for (Vector &column : gradient)
      system.initialize(column);
    for_each_point(table, [&](const auto &patch, const auto &point, auto q) {
      const auto    grad = field_at(table, patch, q, system, field).second;
      const double *N    = table.N(patch, q);
      for (unsigned int k = 0; k < patch.n_nodes; ++k)
        {
          const unsigned int u =
            system.displacement(table.nodes[patch.first_node + k]);
          for (unsigned int i = 0; i < dim; ++i)
            {
              volume.local_element(u + i) += point.volume * N[k];
              for (unsigned int j = 0; j < dim; ++j)
                gradient[j].local_element(u + i) +=
                  point.volume * N[k] * grad[i][j];
            }
        }
    });
    volume.compress(VectorOperation::add);
    for (Vector &column : gradient)
      {
        column.compress(VectorOperation::add);
        for (unsigned int i = 0; i < system.n_owned_displacements(); ++i)
          column.local_element(i) /= volume.local_element(i);
        column.update_ghost_values();
      }

    std::array<double, 3> sums{}; // of squared error, squared field, volume
    for_each_point(table, [&](const auto &patch, const auto &point, auto q) {
      const auto [v, grad] = field_at(table, patch, q, system, field);
      const double h       = patch.cell->extent_in_direction(0);
      double       error   = 0.;
      for (unsigned int j = 0; j < dim; ++j)
        {
          const auto smooth =
            field_at(table, patch, q, system, gradient[j]).first;
          for (unsigned int i = 0; i < dim; ++i)
            error += std::pow(h * (grad[i][j] - smooth[i]), 2);
        }
      sums[0] += point.volume * error;
      sums[1] += point.volume * v.norm_square();
      sums[2] += point.volume;
    });
    for (double &sum : sums)
      sum = Utilities::MPI::sum(sum, field.get_mpi_communicator());
    return {std::sqrt(sums[0] / sums[2]), std::sqrt(sums[1] / sums[2])};
  }

  template RecoveryError
  recovery_error(const SupportTable<2> &,
                 const System<2> &,
                 const Newmark &,
                 const StepFields &);
  template RecoveryError
  recovery_error(const SupportTable<3> &,
                 const System<3> &,
                 const Newmark &,
                 const StepFields &);
} // namespace selkie
