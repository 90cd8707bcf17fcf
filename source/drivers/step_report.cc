#include <selkie/drivers/step_report.h>
#include <selkie/laws/kinematics.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The wall that takes component d of a node's reaction: in a corner the
    /// one that it is normal to; 2 dim if none does.
    template <int dim>
    unsigned int
    wall_of(const unsigned int walls, const unsigned int d)
    {
      unsigned int wall = 2 * dim;
      for (unsigned int w = 0; w < 2 * dim; ++w)
        if ((walls >> w) & 1u)
          if (wall == 2 * dim || w / 2 == d)
            wall = w;
      return wall;
    }
  } // namespace


  template <int dim>
  void
  collect_reactions(const System<dim> &system,
                    const Vector      &residual,
                    const StepFields  &fields,
                    StepReport<dim>   &report)
  {
    const MPI_Comm comm = residual.get_mpi_communicator();
    report.walls.force.assign(2 * dim, Tensor<1, dim>());
    report.walls.moment.assign(2 * dim, Tensor<1, 3>());
    double work = 0.;
    for (const unsigned int node : system.owned_nodes())
      for (unsigned int d = 0; d < dim; ++d)
        {
          const unsigned int i = system.displacement(node) + d;
          if (!system.held(i))
            continue;
          const double R = residual.local_element(i);
          work += R * fields.x.local_element(i);
          const unsigned int wall =
            wall_of<dim>(system.conditions.walls(node), d);
          if (wall == 2 * dim)
            continue;
          Tensor<1, 3> force;
          force[d] = -R;
          report.walls.force[wall][d] -= R;
          report.walls.moment[wall] +=
            cross_product_3d(extend<dim>(system.cloud.position(node)), force);
        }
    for (auto &force : report.walls.force)
      force = Utilities::MPI::sum(force, comm);
    for (auto &moment : report.walls.moment)
      moment = Utilities::MPI::sum(moment, comm);
    report.external_work += Utilities::MPI::sum(work, comm);
  }


  namespace
  {
    template <int dim>
    double
    squared_speed(const System<dim> &system,
                  const StepFields  &fields,
                  const Newmark     &newmark,
                  const unsigned int node)
    {
      double v2 = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        v2 +=
          std::pow(fields.velocity(newmark, system.displacement(node) + d), 2);
      return v2;
    }
  } // namespace


  template <int dim>
  double
  largest_speed(const System<dim> &system,
                const StepFields  &fields,
                const Newmark     &newmark)
  {
    double largest = 0.;
    for (const unsigned int node : system.owned_nodes())
      largest = std::max(largest, squared_speed(system, fields, newmark, node));
    return std::sqrt(
      Utilities::MPI::max(largest,
                          system.partitioner()->get_mpi_communicator()));
  }


  template <int dim>
  void
  collect_motion(const System<dim> &system,
                 const StepFields  &fields,
                 const Newmark     &newmark,
                 StepReport<dim>   &report)
  {
    const MPI_Comm comm    = system.partitioner()->get_mpi_communicator();
    double         kinetic = 0.;
    double         mass    = std::numeric_limits<double>::infinity();
    for (const unsigned int node : system.owned_nodes())
      {
        const double M = fields.mass.local_element(system.displacement(node));
        kinetic += 0.5 * M * squared_speed(system, fields, newmark, node);
        mass = std::min(mass, M);
      }
    report.kinetic            = Utilities::MPI::sum(kinetic, comm);
    report.smallest_node_mass = Utilities::MPI::min(mass, comm);
  }


  template <int dim>
  void
  estimate_time_error(const System<dim> &system,
                      const StepFields  &fields,
                      const Newmark     &newmark,
                      const Inertia     &inertia,
                      StepReport<dim>   &report)
  {
    const double factor = newmark.dt * newmark.dt *
                          (std::abs(inertia.newmark_beta - 1. / 6.) +
                           std::abs(inertia.newmark_gamma - 0.5));
    double sums[3] = {0., 0., 0.}; // of squared error, squared move, mass
    for (unsigned int i = 0; i < system.n_owned_displacements(); ++i)
      {
        const double M   = fields.mass.local_element(i);
        const double x   = fields.x.local_element(i);
        const double a_n = fields.a_n.local_element(i);
        const double a =
          newmark.acceleration(x, fields.v_n.local_element(i), a_n);
        sums[0] += M * std::pow(factor * (a - a_n), 2);
        sums[1] += M * x * x;
        sums[2] += M / dim;
      }
    for (double &sum : sums)
      sum =
        Utilities::MPI::sum(sum, system.partitioner()->get_mpi_communicator());
    report.time_error = std::sqrt(sums[0] / sums[2]);
    report.moved      = std::sqrt(sums[1] / sums[2]);
  }


  namespace
  {
    /// Adds for the pressures at the corners of a cell the squares of the part
    /// that alternates along every edge, and of all.
    template <int dim>
    void
    add_alternating_part(const typename System<dim>::CornerIndices &p,
                         const Vector                              &x,
                         std::array<double, 2>                     &sums)
    {
      constexpr unsigned int n           = 1u << dim;
      double                 alternating = 0.;
      for (unsigned int k = 0; k < n; ++k)
        {
          unsigned int sign = 0;
          for (unsigned int d = 0; d < dim; ++d)
            sign ^= (k >> d) & 1u;
          const double value = x.local_element(p[k]);
          alternating += (sign ? -value : value) / n;
          sums[1] += value * value / n;
        }
      sums[0] += alternating * alternating;
    }
  } // namespace


  template <int dim>
  double
  checkerboard(const System<dim>       &system,
               const SupportTable<dim> &table,
               const StepFields        &fields)
  {
    std::array<double, 2>               sums{}; // alternating, all; squared
    typename System<dim>::CornerIndices p;
    const Patch<dim>                   *last = nullptr;
    for (const auto &patch : table.patches)
      {
        if (last != nullptr && last->cell == patch.cell)
          continue;
        last = &patch;
        for_each_bit(system.pressure_phases, [&](const unsigned int phase) {
          if (system.corner_pressures(patch.cell, phase, p))
            add_alternating_part<dim>(p, fields.x, sums);
        });
      }
    for (double &sum : sums)
      sum =
        Utilities::MPI::sum(sum, system.partitioner()->get_mpi_communicator());
    return sums[1] > 0. ? std::sqrt(sums[0] / sums[1]) : 0.;
  }

#define INSTANTIATE(dim)                                   \
  template void   collect_reactions(const System<dim> &,   \
                                    const Vector &,        \
                                    const StepFields &,    \
                                    StepReport<dim> &);    \
  template double largest_speed(const System<dim> &,       \
                                const StepFields &,        \
                                const Newmark &);          \
  template void   collect_motion(const System<dim> &,      \
                                 const StepFields &,       \
                                 const Newmark &,          \
                                 StepReport<dim> &);       \
  template void   estimate_time_error(const System<dim> &, \
                                      const StepFields &,  \
                                      const Newmark &,     \
                                      const Inertia &,     \
                                      StepReport<dim> &);  \
  template double checkerboard(const System<dim> &,        \
                               const SupportTable<dim> &,  \
                               const StepFields &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
