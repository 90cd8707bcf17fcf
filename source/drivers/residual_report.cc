#include <selkie/base/exceptions.h>
#include <selkie/drivers/residual_report.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// An unknown of this rank, and how far its residual is off.
    struct Worst
    {
      unsigned int unknown = invalid_index;
      double       size    = -1.; ///< infinity where it is not finite
    };

    /// Of the free unknowns, each in the units of its scale. Invalid on all
    /// ranks but the one that owns it (the first of several).
    template <int dim>
    Worst
    find_worst(const System<dim>    &system,
               const ResidualScales &scales,
               const Vector         &residual)
    {
      Worst worst;
      for (unsigned int i = 0; i < system.n_owned(); ++i)
        if (!system.held(i))
          {
            const double scale =
              i < system.n_owned_displacements() ? scales.u : scales.p;
            double size = std::abs(residual.local_element(i)) / scale;
            if (!std::isfinite(size))
              size = std::numeric_limits<double>::infinity();
            if (size > worst.size)
              worst = {i, size};
          }
      const MPI_Comm     comm    = residual.get_mpi_communicator();
      const unsigned int me      = Utilities::MPI::this_mpi_process(comm);
      const double       largest = Utilities::MPI::max(worst.size, comm);
      // A rank without free unknowns has none, but takes part.
      const bool         mine  = worst.size >= 0. && worst.size == largest;
      const unsigned int first = Utilities::MPI::min(
        mine ? me : std::numeric_limits<unsigned int>::max(), comm);
      return first == me ? worst : Worst();
    }

    /// "... at the node (x), in x, next to the point (x) of body 'b'"
    template <int dim>
    std::string
    describe_place(const Scene<dim>        &scene,
                   const System<dim>       &system,
                   const SupportTable<dim> &table,
                   const unsigned int       unknown)
    {
      const unsigned int n_u      = system.n_owned_displacements();
      const bool         pressure = unknown >= n_u;
      const unsigned int node     = pressure
                                      ? system.owned_pressures()[unknown - n_u].node
                                      : system.owned_nodes()[unknown / dim];
      const Point<dim>   x        = system.cloud.position(node);
      std::ostringstream out;
      out << " at the node (" << x << "), in "
          << (pressure ? "the pressure" : std::string(1, "xyz"[unknown % dim]));
      const auto nearest = std::min_element(table.points.begin(),
                                            table.points.end(),
                                            [&x](const auto &a, const auto &b) {
                                              return a.x.distance_square(x) <
                                                     b.x.distance_square(x);
                                            });
      if (nearest != table.points.end())
        out << ", next to the point (" << nearest->x << ") of body '"
            << scene.bodies[nearest->body].name << "'";
      return out.str();
    }
  } // namespace


  template <int dim>
  std::string
  describe_residual(const Scene<dim>                                    &scene,
                    const std::vector<std::shared_ptr<const Term<dim>>> &terms,
                    System<dim>                                         &system,
                    const SupportTable<dim>                             &table,
                    const StepTime                                      &time,
                    StepFields                                          &fields,
                    const ResidualScales                                &scales,
                    const Vector &residual)
  {
    const Worst        worst = find_worst(system, scales, residual);
    const bool         mine  = worst.unknown != invalid_index;
    std::ostringstream out;
    out.precision(3);
    if (mine)
      out << "The residual is largest"
          << describe_place(scene, system, table, worst.unknown) << ":";
    Vector part(residual);
    for (const auto &term : terms)
      {
        const std::vector<std::shared_ptr<const Term<dim>>> alone = {term};
        try
          {
            Assembler<dim>(alone, system)
              .assemble(table, time, fields, scales.pressure_unit, false, part);
            if (mine)
              out << ' ' << term->name() << ' '
                  << part.local_element(worst.unknown) << ',';
          }
        catch (const InvertedPoint &) // on all ranks
          {
            out << ' ' << term->name() << " not defined,";
          }
      }
    if (mine)
      out << " together " << residual.local_element(worst.unknown) << ' '
          << (worst.unknown < system.n_owned_displacements()
                ? (dim == 2 ? "N/m" : "N")
                : (dim == 2 ? "m^2" : "m^3"));
    // Told by the rank that knows.
    const MPI_Comm     comm = residual.get_mpi_communicator();
    const unsigned int root =
      Utilities::MPI::max(mine ? Utilities::MPI::this_mpi_process(comm) : 0u,
                          comm);
    return Utilities::MPI::broadcast(comm, out.str(), root);
  }

#define INSTANTIATE(dim)                                   \
  template std::string describe_residual(                  \
    const Scene<dim> &,                                    \
    const std::vector<std::shared_ptr<const Term<dim>>> &, \
    System<dim> &,                                         \
    const SupportTable<dim> &,                             \
    const StepTime &,                                      \
    StepFields &,                                          \
    const ResidualScales &,                                \
    const Vector &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
