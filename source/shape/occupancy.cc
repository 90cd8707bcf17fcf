#include <selkie/base/exceptions.h>
#include <selkie/shape/occupancy.h>

#include <deal.II/lac/la_parallel_vector.h>

namespace selkie
{
  using namespace dealii;
  using NodeVector = LinearAlgebra::distributed::Vector<double>;

  namespace
  {
    /// The phases of the points in each locally owned cell that holds any, as
    /// bits; in the order of the points.
    template <int dim>
    std::vector<std::pair<typename NodeCloud<dim>::Cell, unsigned int>>
    occupied_cells(const ParticleSet<dim> &particles)
    {
      std::vector<std::pair<typename NodeCloud<dim>::Cell, unsigned int>> cells;
      for (const auto &particle : particles.handler())
        {
          const typename NodeCloud<dim>::Cell cell =
            particle.get_surrounding_cell();
          const auto body = static_cast<unsigned int>(
            particles.columns.body(particle.get_properties()));
          const unsigned int bit = 1u << particles.scene.bodies[body].phase;
          if (cells.empty() || cells.back().first != cell)
            cells.emplace_back(cell, bit);
          else
            cells.back().second |= bit;
        }
      return cells;
    }
  } // namespace

  template <int dim>
  Occupancy<dim>
  find_occupancy(const ParticleSet<dim> &particles,
                 const NodeCloud<dim>   &cloud,
                 const bool              want_enclosed)
  {
    std::vector<unsigned int> layer_of_phase;
    for (const auto &body : particles.scene.bodies)
      {
        layer_of_phase.resize(
          std::max<std::size_t>(layer_of_phase.size(), body.phase + 1));
        layer_of_phase[body.phase] = body.layer;
      }
    const unsigned int n_phases = layer_of_phase.size();
    Assert(n_phases <= 32, ExcInternalError()); // check_geometry() said so

    const auto     cells = occupied_cells(particles);
    Occupancy<dim> result;
    NodeVector     mark(cloud.partitioner());
    result.active.assign(cloud.size(), 0);

    for (unsigned int phase = 0; phase < n_phases; ++phase)
      {
        mark = 0.;
        for (const auto &[cell, phases] : cells)
          if (phases & (1u << phase))
            for (const unsigned int node :
                 cloud.corners(cell, layer_of_phase[phase]))
              mark.local_element(node) = 1.;
        mark.compress(VectorOperation::max);
        mark.update_ghost_values();
        for (unsigned int node = 0; node < cloud.size(); ++node)
          if (mark.local_element(node) > 0.)
            result.active[node] |= 1u << phase;
        mark.zero_out_ghost_values();
      }

    if (want_enclosed)
      {
        // Count the fluid cells around each node; a solid one spoils the sum.
        mark = 0.;
        for (const auto &[cell, phases] : cells)
          for (const unsigned int node : cloud.corners(cell))
            mark.local_element(node) += (phases == 1u) ? 1. : -1e3;
        mark.compress(VectorOperation::add);
        mark.update_ghost_values();
        result.enclosed.resize(cloud.size());
        for (unsigned int node = 0; node < cloud.size(); ++node)
          result.enclosed[node] =
            mark.local_element(node) == cloud.n_cells_around(node);
      }
    return result;
  }

  template Occupancy<2>
  find_occupancy(const ParticleSet<2> &, const NodeCloud<2> &, const bool);
  template Occupancy<3>
  find_occupancy(const ParticleSet<3> &, const NodeCloud<3> &, const bool);
} // namespace selkie
