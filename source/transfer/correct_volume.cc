#include <selkie/laws/fluid_law.h>
#include <selkie/transfer/transfer.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The hat functions of a box-shaped cell at x.
    template <int dim>
    std::array<double, (1u << dim)>
    hats(const Patch<dim> &patch, const Point<dim> &x)
    {
      const Point<dim> unit = patch.cell->bounding_box().real_to_unit(x);
      std::array<double, (1u << dim)> values;
      for (unsigned int v = 0; v < values.size(); ++v)
        values[v] = GeometryInfo<dim>::d_linear_shape_function(unit, v);
      return values;
    }

    /// theta at the nodes: volume of the points around over that of the cells.
    template <int dim>
    Vector
    crowding(const NodeCloud<dim> &cloud, const SupportTable<dim> &table)
    {
      Vector theta(cloud.partitioner());
      for (const auto &patch : table.patches)
        if (patch.matter)
          {
            const auto corners = cloud.corners(patch.cell);
            for (unsigned int q = 0; q < patch.n_points; ++q)
              {
                const auto  &point = table.points[patch.first_point + q];
                const double volume =
                  point.volume *
                  (patch.fluid ? point.J_n : determinant(point.F_n));
                const auto share = hats(patch, point.x);
                for (unsigned int v = 0; v < corners.size(); ++v)
                  theta.local_element(corners[v]) += volume * share[v];
              }
          }
      theta.compress(VectorOperation::add);
      for (unsigned int node = 0; node < cloud.n_owned(); ++node)
        theta.local_element(node) /= cloud.volume(node);
      theta.update_ghost_values();
      return theta;
    }
    /// Mean of theta - 1 over the nodes deep inside the fluid, with full cells
    /// all around: nearer to the surface cells are filled in part. 0 if there
    /// are none. Collective.
    template <int dim>
    double
    mean_excess(const Vector            &theta,
                const NodeCloud<dim>    &cloud,
                const SupportTable<dim> &table)
    {
      Vector full_cells(cloud.partitioner());
      for (const auto &patch : table.patches)
        if (patch.fluid && patch.matter && !patch.integration)
          for (const unsigned int node : cloud.corners(patch.cell))
            full_cells.local_element(node) += 1.;
      full_cells.compress(VectorOperation::add);
      std::array<double, 2> sums{}; // of excess, of volume
      for (unsigned int node = 0; node < cloud.n_owned(); ++node)
        if (full_cells.local_element(node) == cloud.n_cells_around(node))
          {
            sums[0] += cloud.volume(node) * (theta.local_element(node) - 1.);
            sums[1] += cloud.volume(node);
          }
      for (double &sum : sums)
        sum = Utilities::MPI::sum(sum, theta.get_mpi_communicator());
      return sums[1] > 0. ? sums[0] / sums[1] : 0.;
    }
  } // namespace

  template <int dim>
  VolumeCorrection
  correct_volume(const FluidPressure &parameters,
                 const double         dt,
                 const double         last_excess,
                 const System<dim>   &system,
                 SupportTable<dim>   &table)
  {
    VolumeCorrection result;
    const auto       share = [&](const double part_of_rate) {
      return 1. - std::exp(-part_of_rate * parameters.volume_rate * dt);
    };
    const Vector theta = crowding(system.cloud, table);
    result.excess =
      last_excess +
      share(0.5) * (mean_excess(theta, system.cloud, table) - last_excess);
    // How far each point is beyond the deadband, and the mean of that: the
    // local part of the correction only moves volume from one place to another.
    std::vector<double>   crowd(table.points.size());
    std::array<double, 2> sums{}; // of crowd, of volume
    for (const auto &patch : table.patches)
      if (patch.fluid && !patch.surface)
        {
          const auto corners = system.cloud.corners(patch.cell);
          for (unsigned int q = 0; q < patch.n_points; ++q)
            {
              const unsigned int i       = patch.first_point + q;
              const auto         weights = hats(patch, table.points[i].x);
              double             theta_q = 0.;
              for (unsigned int v = 0; v < corners.size(); ++v)
                theta_q += weights[v] * theta.local_element(corners[v]);
              crowd[i] =
                std::clamp(theta_q - 1. - parameters.volume_deadband, 0., 0.2);
              if (!patch.integration)
                continue;
              const double V = table.points[i].volume * table.points[i].J_n;
              sums[0] += V * crowd[i];
              sums[1] += V;
            }
        }
    for (double &sum : sums)
      sum = Utilities::MPI::sum(sum, theta.get_mpi_communicator());
    const double mean_crowd = sums[1] > 0. ? sums[0] / sums[1] : 0.;

    for (const auto &patch : table.patches)
      if (patch.fluid && !patch.surface)
        for (unsigned int i = patch.first_point;
             i < patch.first_point + patch.n_points;
             ++i)
          {
            auto        &point = table.points[i];
            const double shrink =
              share(1.) * (crowd[i] - mean_crowd) + share(0.25) * result.excess;
            if (patch.integration)
              result.energy +=
                point.volume * point.J_n * shrink *
                static_cast<const FluidLaw &>(*point.law).pressure(point.J_n);
            point.J_n *= 1. - shrink;
          }
    return result;
  }

  template VolumeCorrection
  correct_volume(const FluidPressure &,
                 const double,
                 const double,
                 const System<2> &,
                 SupportTable<2> &);
  template VolumeCorrection
  correct_volume(const FluidPressure &,
                 const double,
                 const double,
                 const System<3> &,
                 SupportTable<3> &);
} // namespace selkie
