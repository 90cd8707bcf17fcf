#include <selkie/drivers/residual_scales.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Weight and inertia of the nodes, at least the round-off of the stresses.
    template <int dim>
    double
    force_scale(const Scene<dim>  &scene,
                const System<dim> &system,
                const StepFields  &fields,
                const Newmark     &newmark,
                const double       g)
    {
      double sum = 0.;
      for (unsigned int i = 0;
           scene.inertia && i < system.n_owned_displacements();
           ++i)
        {
          const double M = fields.mass.local_element(i);
          sum += std::pow(M * g, 2) +
                 std::pow(M * newmark.alpha1 * fields.x.local_element(i), 2) +
                 std::pow(M * newmark.alpha2 * fields.v_n.local_element(i), 2);
        }
      const double forces = std::sqrt(
        Utilities::MPI::sum(sum, system.partitioner()->get_mpi_communicator()));

      // Round-off of strains of order 1, summed over the points around a node
      // (some 8), is the least that can be asked for.
      double stiffness = 0.;
      for (const auto &body : scene.bodies)
        stiffness =
          std::max(stiffness,
                   body.law->density() * std::pow(body.law->sound_speed(), 2));
      const double round_off =
        8. * std::numeric_limits<double>::epsilon() * stiffness *
        std::pow(system.cloud.smallest_spacing(), dim - 1) *
        std::sqrt(double(system.n_global()));
      return std::max(forces, round_off / scene.newton.tolerance);
    }
  } // namespace


  template <int dim>
  std::array<double, 2>
  residual_norms(const System<dim> &system, const Vector &residual)
  {
    std::array<double, 2> sums{};
    for (unsigned int i = 0; i < system.n_owned(); ++i)
      if (!system.held(i))
        sums[i < system.n_owned_displacements() ? 0 : 1] +=
          residual.local_element(i) * residual.local_element(i);
    for (double &sum : sums)
      sum =
        std::sqrt(Utilities::MPI::sum(sum, residual.get_mpi_communicator()));
    return sums;
  }


  template <int dim>
  ResidualScales
  ResidualScales::of_step(const Scene<dim>  &scene,
                          const System<dim> &system,
                          const StepFields  &fields,
                          const Newmark     &newmark,
                          const double       acceleration)
  {
    ResidualScales scales;
    scales.u = force_scale(scene, system, fields, newmark, acceleration);
    if (!scene.has_pressure())
      return scales;
    double sum = 0.;
    for (const auto &pressure : system.owned_pressures())
      sum += std::pow(system.cloud.volume(pressure.node), 2);
    scales.p = std::sqrt(
      Utilities::MPI::sum(sum, system.partitioner()->get_mpi_communicator()));
    for (const auto &body : scene.bodies)
      if (body.law->phase() == Phase::fluid)
        scales.pressure_unit =
          std::max(scales.pressure_unit,
                   body.law->density() *
                     std::pow(system.cloud.smallest_spacing(), 2) *
                     newmark.alpha1);
    return scales;
  }


  double
  ResidualScales::error(const std::array<double, 2> &norms,
                        const double                 tolerance) const
  {
    return std::max(norms[0] / (tolerance * u),
                    p > 0. ? norms[1] / (1e-3 * tolerance * p) : 0.);
  }

#define INSTANTIATE(dim)                                                      \
  template std::array<double, 2> residual_norms(const System<dim> &,          \
                                                const Vector &);              \
  template ResidualScales        ResidualScales::of_step(const Scene<dim> &,  \
                                                  const System<dim> &, \
                                                  const StepFields &,  \
                                                  const Newmark &,     \
                                                  const double)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
