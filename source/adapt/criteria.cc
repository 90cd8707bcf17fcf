#include <selkie/adapt/criteria.h>
#include <selkie/adapt/occupied_cell.h>
#include <selkie/adapt/strain_criteria.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/scene/check_scene.h>
#include <selkie/shape/occupancy.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The cells with points, in the order of the points.
    template <int dim>
    std::vector<OccupiedCell<dim>>
    cells_with_points(const ParticleSet<dim> &particles)
    {
      std::vector<OccupiedCell<dim>> cells;
      for (const auto &point : particles.handler())
        {
          const typename NodeCloud<dim>::Cell cell =
            point.get_surrounding_cell();
          if (cells.empty() || cells.back().cell != cell)
            cells.push_back({cell});
        }
      return cells;
    }

    /// How many of some cells meet at each node, on any rank.
    template <int dim>
    class CellsAround
    {
    public:
      explicit CellsAround(const NodeCloud<dim> &cloud)
        : cloud(cloud)
        , number(cloud.partitioner())
      {}

      void
      add(const typename NodeCloud<dim>::Cell &cell)
      {
        for (const unsigned int node : cloud.corners(cell))
          number.local_element(node) += 1.;
      }

      /// After the last cell. Collective.
      void
      finish()
      {
        number.compress(VectorOperation::add);
        number.update_ghost_values();
      }

      double
      operator()(const unsigned int node) const
      {
        return number.local_element(node);
      }

    private:
      const NodeCloud<dim> &cloud;
      Vector                number;
    };

    /// Cells with a corner that some empty cell shares, but not one that cells
    /// with points enclose: water that is stretched has holes between its
    /// points.
    template <int dim>
    void
    mark_surface(const NodeCloud<dim>           &cloud,
                 std::vector<OccupiedCell<dim>> &cells)
    {
      const auto &mesh = cloud.dof_handler().get_triangulation();

      CellsAround<dim>  matter(cloud), holes(cloud);
      std::vector<bool> has_points(mesh.n_active_cells(), false);
      for (const auto &one : cells)
        {
          matter.add(one.cell);
          has_points[one.cell->active_cell_index()] = true;
        }
      matter.finish();
      for (const auto &cell : mesh.active_cell_iterators())
        if (cell->is_locally_owned() && !has_points[cell->active_cell_index()])
          {
            const auto corners = cloud.corners(cell);
            if (std::all_of(corners.begin(),
                            corners.end(),
                            [&matter](const unsigned int node) {
                              return matter(node) > 0.;
                            }))
              holes.add(cell);
          }
      holes.finish();
      for (auto &one : cells)
        for (const unsigned int node : cloud.corners(one.cell))
          if (matter(node) + holes(node) < cloud.n_cells_around(node))
            one.excess = std::max(one.excess, 1.);
    }

    /// Cells with a corner that several phases share.
    template <int dim>
    void
    mark_interface(const ParticleSet<dim>         &particles,
                   const NodeCloud<dim>           &cloud,
                   std::vector<OccupiedCell<dim>> &cells)
    {
      const auto occupancy = find_occupancy(particles, cloud, false);
      for (auto &one : cells)
        for (const unsigned int node : cloud.corners(one.cell))
          {
            const unsigned int phases = occupancy.active[node];
            if ((phases & (phases - 1)) != 0)
              one.excess = std::max(one.excess, 1.);
          }
    }

    template <int dim>
    void
    mark_bodies(const ParticleSet<dim>         &particles,
                std::vector<OccupiedCell<dim>> &cells)
    {
      const auto &bodies = particles.scene.adaptivity->bodies;
      for_each_point(
        particles, cells, [&](const unsigned int i, const auto &point) {
          const auto body = static_cast<unsigned int>(
            particles.columns.body(point.get_properties()));
          if (std::find(bodies.begin(), bodies.end(), body) != bodies.end())
            cells[i].excess = std::max(cells[i].excess, 1.);
        });
    }

    /// The largest value of all nodes of all ranks.
    template <int dim, typename Value>
    double
    largest_of_nodes(const NodeCloud<dim> &cloud, const Value &value)
    {
      double largest = 0.;
      for (unsigned int node = 0; node < cloud.n_owned(); ++node)
        largest = std::max(largest, std::abs(value(node)));
      return Utilities::MPI::max(largest,
                                 cloud.partitioner()->get_mpi_communicator());
    }

    template <int dim>
    Tensor<1, dim>
    velocity_of(const NodalView<dim> &nodes, const unsigned int node)
    {
      Tensor<1, dim> v;
      for (unsigned int d = 0; d < dim; ++d)
        v[d] = (*nodes.velocity)[d].local_element(node);
      return v;
    }

    template <int dim>
    double
    largest_speed(const NodeCloud<dim> &cloud, const NodalView<dim> &nodes)
    {
      return largest_of_nodes(cloud, [&nodes](const unsigned int node) {
        return velocity_of(nodes, node).norm();
      });
    }

    /// The largest difference between two corners of each cell.
    template <int dim, typename Difference>
    std::vector<double>
    differences(const NodeCloud<dim>                 &cloud,
                const NodalView<dim>                 &nodes,
                const std::vector<OccupiedCell<dim>> &cells,
                const Difference                     &difference)
    {
      std::vector<double> figures;
      for (const auto &one : cells)
        {
          double     largest = 0.;
          const auto corners = cloud.corners(one.cell);
          for (const unsigned int a : corners)
            for (const unsigned int b : corners)
              if (a < b && nodes.mass->local_element(a) > 0. &&
                  nodes.mass->local_element(b) > 0.)
                largest = std::max(largest, difference(a, b));
          figures.push_back(largest);
        }
      return figures;
    }

    template <int dim>
    void
    limit_velocity(const NodeCloud<dim>           &cloud,
                   const NodalView<dim>           &nodes,
                   const double                    most,
                   std::vector<OccupiedCell<dim>> &cells)
    {
      limit(cells,
            differences(
              cloud,
              nodes,
              cells,
              [&nodes](const unsigned int a, const unsigned int b) {
                return (velocity_of(nodes, a) - velocity_of(nodes, b)).norm();
              }),
            most * largest_speed(cloud, nodes));
    }

    template <int dim>
    void
    limit_pressure(const NodeCloud<dim>           &cloud,
                   const NodalView<dim>           &nodes,
                   const double                    most,
                   std::vector<OccupiedCell<dim>> &cells)
    {
      const auto value = [&nodes](const unsigned int node) {
        return nodes.pressure->local_element(node);
      };
      limit(cells,
            differences(cloud,
                        nodes,
                        cells,
                        [&value](const unsigned int a, const unsigned int b) {
                          return std::abs(value(a) - value(b));
                        }),
            most * largest_of_nodes(cloud, value));
    }

    /// What the cell's parent would miss of the velocity: its value in the
    /// centre less the mean of the corners. 0 where the parent's children are
    /// not all there, or not all in use.
    template <int dim>
    double
    missed_by_parent(const NodeCloud<dim>                &cloud,
                     const NodalView<dim>                &nodes,
                     const typename NodeCloud<dim>::Cell &cell)
    {
      constexpr unsigned int n = 1u << dim;
      if (cell->level() == 0)
        return 0.;
      const auto     parent = cell->parent();
      Tensor<1, dim> miss;
      for (unsigned int c = 0; c < n; ++c)
        {
          const auto child = parent->child(c);
          if (!child->is_active() || !child->is_locally_owned())
            return 0.;
          const auto corners = cloud.corners(child);
          for (const unsigned int node : {corners[c], corners[n - 1 - c]})
            if (nodes.mass->local_element(node) <= 0.)
              return 0.;
          miss += (velocity_of(nodes, corners[n - 1 - c]) -
                   velocity_of(nodes, corners[c])) /
                  n;
        }
      return miss.norm();
    }

    template <int dim>
    void
    limit_error(const NodeCloud<dim>           &cloud,
                const NodalView<dim>           &nodes,
                const double                    most,
                std::vector<OccupiedCell<dim>> &cells)
    {
      std::vector<double> figures;
      for (const auto &one : cells)
        figures.push_back(missed_by_parent(cloud, nodes, one.cell));
      limit(cells, figures, most * largest_speed(cloud, nodes));
    }

    /// The box of a cell with so much around it (m).
    template <int dim>
    BoundingBox<dim>
    box_around(const typename NodeCloud<dim>::Cell &cell, const double buffer)
    {
      auto box = cell->bounding_box();
      box.extend(buffer);
      return box;
    }
  } // namespace


  template <int dim>
  std::vector<typename WantedLevels<dim>::Part>
  wanted_parts(const ParticleSet<dim> &particles,
               const NodeCloud<dim>   &cloud,
               const NodalView<dim>   &nodes)
  {
    const auto &wishes = *particles.scene.adaptivity;
    auto        cells  = cells_with_points(particles);
    if (wishes.surface)
      mark_surface(cloud, cells);
    if (wishes.interface)
      mark_interface(particles, cloud, cells);
    if (!wishes.bodies.empty())
      mark_bodies(particles, cells);
    if (wishes.strain > 0. || wishes.strain_variation > 0. ||
        wishes.strain_error > 0.)
      limit_strain(particles, cloud, cells);
    if (nodes.velocity != nullptr && wishes.velocity > 0.)
      limit_velocity(cloud, nodes, wishes.velocity, cells);
    if (nodes.pressure != nullptr && wishes.pressure > 0.)
      limit_pressure(cloud, nodes, wishes.pressure, cells);
    if (nodes.velocity != nullptr && wishes.error > 0.)
      limit_error(cloud, nodes, wishes.error, cells);

    const auto  &domain = particles.scene.domain;
    const auto   finest = base_level(domain) + wishes.finer;
    const double buffer = wishes.buffer * finest_spacing(domain, wishes);
    std::vector<typename WantedLevels<dim>::Part> parts;
    for (const auto &one : cells)
      {
        const bool fine =
          static_cast<unsigned int>(one.cell->level()) >= finest;
        if (one.excess >= (fine ? 0.5 : 1.))
          parts.push_back({box_around<dim>(one.cell, buffer), finest});
        // An element's error stays in it.
        if (one.level > 0)
          parts.push_back(
            {box_around<dim>(one.cell,
                             particles.scene.lagrangian_mesh() ? 0. : buffer),
             one.level});
      }
    return parts;
  }


  template <int dim>
  double
  finest_spacing(const Domain<dim> &domain, const Adaptivity &wishes)
  {
    return std::ldexp(cell_size(domain), -int(wishes.finer));
  }


#define INSTANTIATE(dim)                                                       \
  template std::vector<typename WantedLevels<dim>::Part> wanted_parts(         \
    const ParticleSet<dim> &, const NodeCloud<dim> &, const NodalView<dim> &); \
  template double finest_spacing(const Domain<dim> &, const Adaptivity &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
