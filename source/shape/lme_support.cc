#include <selkie/laws/fluid_law.h>
#include <selkie/shape/gather_points.h>
#include <selkie/shape/lme.h>
#include <selkie/shape/lme_support.h>

#include <deal.II/base/qprojector.h>
#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Appends the nodes that the phase may use near the cell and sets the
    /// patch's node range.
    template <int dim>
    void
    append_nodes(const NodeCloud<dim> &cloud,
                 const Occupancy<dim> &occupancy,
                 Patch<dim>           &patch,
                 SupportTable<dim>    &table)
    {
      patch.first_node = table.nodes.size();
      for (const unsigned int node : cloud.nodes_near(patch.cell))
        if (occupancy.has_phase(node, patch.phase))
          table.nodes.push_back(node);
      patch.n_nodes  = table.nodes.size() - patch.first_node;
      patch.n_padded = lme_padded(patch.n_nodes);
    }

    /// The numbers that a patch has in SupportTable::data.
    template <int dim>
    std::size_t
    data_size(const Patch<dim> &patch)
    {
      return std::size_t(patch.n_points) * (dim + 1) * patch.n_padded;
    }

    /// Shape functions of all points of a patch.
    template <int dim>
    void
    evaluate_patch(const NodeCloud<dim> &cloud,
                   Patch<dim>           &patch,
                   SupportTable<dim>    &table)
    {
      static thread_local std::vector<Point<dim>> positions;
      static thread_local std::vector<double>     betas;
      static thread_local LmeNodes<dim>           nodes;
      positions.clear();
      betas.clear();
      double h = std::numeric_limits<double>::max();
      for (unsigned int a = 0; a < patch.n_nodes; ++a)
        {
          const unsigned int node = table.nodes[patch.first_node + a];
          positions.push_back(cloud.position(node));
          betas.push_back(cloud.beta(node));
          h = std::min(h, cloud.spacing(node));
        }
      nodes.reinit(positions, betas, h);

      patch.data = table.data.size();
      table.data.resize_fast(patch.data + data_size(patch));
      for (unsigned int q = 0; q < patch.n_points; ++q)
        {
          StepPoint<dim>    &point = table.points[patch.first_point + q];
          double            *N     = const_cast<double *>(table.N(patch, q));
          const unsigned int iterations =
            lme_evaluate(nodes, point.x, point.lambda, N, N + patch.n_padded);
          if (!patch.matter)
            continue; // kept from step to step: counted by chance
          table.newton_iterations += iterations;
          table.max_newton_iterations =
            std::max(table.max_newton_iterations, iterations);
        }
    }

    template <int dim>
    bool
    is_full(const NodeCloud<dim> &cloud,
            const Occupancy<dim> &occupancy,
            const Patch<dim>     &patch)
    {
      if (!patch.fluid || occupancy.enclosed.empty())
        return false;
      const auto corners = cloud.corners(patch.cell);
      return std::all_of(corners.begin(), corners.end(), [&](const auto node) {
        return occupancy.enclosed[node];
      });
    }

    /// 2^dim Gauss points for each spacing of the nodes that reach into the
    /// cell: functions of finer nodes are steeper.
    template <int dim>
    const Quadrature<dim> &
    gauss_points(const NodeCloud<dim>    &cloud,
                 const SupportTable<dim> &table,
                 const Patch<dim>        &patch)
    {
      static const std::array<Quadrature<dim>, 4> rules = {
        {QIterated<dim>(QGauss<1>(2), 1),
         QIterated<dim>(QGauss<1>(2), 2),
         QIterated<dim>(QGauss<1>(2), 3),
         QIterated<dim>(QGauss<1>(2), 4)}};
      double finest = std::numeric_limits<double>::max();
      for (unsigned int a = 0; a < patch.n_nodes; ++a)
        finest =
          std::min(finest, cloud.spacing(table.nodes[patch.first_node + a]));
      const double ratio = patch.cell->extent_in_direction(0) / finest;
      return rules[std::clamp(static_cast<int>(std::lround(ratio)), 1, 4) - 1];
    }

    /// Shape functions of a full cell's patch, computed or, if its nodes are
    /// those of the last time, copied.
    template <int dim>
    void
    evaluate_full_cell(const NodeCloud<dim> &cloud,
                       GaussSupports<dim>   &known,
                       Patch<dim>           &patch,
                       SupportTable<dim>    &table)
    {
      auto                     &cell  = known.of(patch.cell);
      const unsigned int *const nodes = &table.nodes[patch.first_node];
      const std::size_t         size  = data_size(patch);
      if (cell.values.size() == size && std::equal(cell.nodes.begin(),
                                                   cell.nodes.end(),
                                                   nodes,
                                                   nodes + patch.n_nodes))
        {
          patch.data = table.data.size();
          table.data.resize_fast(patch.data + size);
          std::copy(cell.values.begin(),
                    cell.values.end(),
                    table.data.begin() + patch.data);
          return;
        }
      evaluate_patch(cloud, patch, table);
      cell.nodes.assign(nodes, nodes + patch.n_nodes);
      cell.values.resize_fast(size);
      std::copy(table.data.begin() + patch.data,
                table.data.end(),
                cell.values.begin());
    }
  } // namespace

  template <int dim>
  void
  fill_material_points(const ParticleSet<dim> &particles,
                       const NodeCloud<dim>   &cloud,
                       const Occupancy<dim>   &occupancy,
                       SupportTable<dim>      &table)
  {
    gather_points(particles, table);
    std::size_t size = 0;
    for (Patch<dim> &patch : table.patches)
      {
        append_nodes(cloud, occupancy, patch, table);
        patch.integration = !is_full(cloud, occupancy, patch);
        size += data_size(patch);
      }
    table.reserve_data(size);
    for (Patch<dim> &patch : table.patches)
      evaluate_patch(cloud, patch, table);
  }

  template <int dim>
  void
  add_gauss_points(
    const NodeCloud<dim>                             &cloud,
    const LinearAlgebra::distributed::Vector<double> &nodal_pressure,
    GaussSupports<dim>                               &known,
    SupportTable<dim>                                &table)
  {
    const unsigned int n_matter = table.patches.size();
    std::size_t        size     = 0;
    for (unsigned int i = 0; i < n_matter; ++i)
      if (!table.patches[i].integration)
        {
          Patch<dim> patch = table.patches[i];
          patch.n_points   = gauss_points(cloud, table, patch).size();
          size += data_size(patch);
        }
    table.reserve_data(size);
    for (unsigned int i = 0; i < n_matter; ++i)
      if (!table.patches[i].integration)
        {
          Patch<dim>  patch = table.patches[i]; // same cell, same nodes
          const auto &gauss = gauss_points(cloud, table, patch);
          patch.matter      = false;
          patch.integration = true;
          patch.first_point = table.points.size();
          patch.n_points    = gauss.size();

          // The law of a full cell is that of its first point: bodies of
          // different fluids do not mix inside a cell.
          StepPoint<dim> point = table.points[table.patches[i].first_point];
          const auto    &fluid = static_cast<const FluidLaw &>(*point.law);
          point.mass           = 0.;
          point.lambda         = Tensor<1, dim>();
          const auto box       = patch.cell->bounding_box();
          for (unsigned int q = 0; q < gauss.size(); ++q)
            {
              point.x = box.unit_to_real(gauss.point(q));
              table.points.push_back(point);
            }
          evaluate_full_cell(cloud, known, patch, table);

          for (unsigned int q = 0; q < gauss.size(); ++q)
            {
              const double *N = table.N(patch, q);
              double        p = 0.;
              for (unsigned int a = 0; a < patch.n_nodes; ++a)
                p += N[a] * nodal_pressure.local_element(
                              table.nodes[patch.first_node + a]);
              StepPoint<dim> &x = table.points[patch.first_point + q];
              x.J_n             = fluid.J_of_pressure(p);
              x.volume          = gauss.weight(q) * box.volume() / x.J_n;
            }
          table.patches.push_back(patch);
        }
  }

  template <int dim>
  void
  add_wall_points(const NodeCloud<dim>            &cloud,
                  const std::array<bool, 2 * dim> &walls,
                  SupportTable<dim>               &table)
  {
    static const QGauss<dim - 1> gauss(2);
    constexpr double             inside   = 1e-5;
    const unsigned int           n_before = table.patches.size();
    for (unsigned int i = 0; i < n_before; ++i)
      if (table.patches[i].fluid && table.patches[i].matter &&
          table.patches[i].cell->at_boundary())
        {
          const Patch<dim> of_cell = table.patches[i];
          const auto       box     = of_cell.cell->bounding_box();
          double           volume  = 0.;
          for (unsigned int q = 0; q < of_cell.n_points; ++q)
            {
              const auto &point = table.points[of_cell.first_point + q];
              volume += point.volume * point.J_n;
            }
          const double filled = std::min(1., volume / box.volume());
          for (unsigned int face = 0; face < 2 * dim; ++face)
            if (walls[face] && of_cell.cell->at_boundary(face))
              {
                Patch<dim> patch  = of_cell; // same cell, same nodes
                patch.matter      = false;
                patch.integration = false;
                patch.surface     = true;
                patch.first_point = table.points.size();
                patch.n_points    = gauss.size();

                StepPoint<dim> point = table.points[of_cell.first_point];
                point.mass = point.volume = 0.;
                point.lambda              = Tensor<1, dim>();
                const auto unit_points    = QProjector<dim>::project_to_face(
                  ReferenceCells::get_hypercube<dim>(), gauss, face);
                for (unsigned int q = 0; q < gauss.size(); ++q)
                  {
                    Point<dim> unit = unit_points.point(q);
                    unit[face / 2] =
                      std::clamp(unit[face / 2], inside, 1. - inside);
                    point.x    = box.unit_to_real(unit);
                    point.area = filled * gauss.weight(q) * box.volume() /
                                 box.side_length(face / 2);
                    table.points.push_back(point);
                  }
                evaluate_patch(cloud, patch, table);
                table.patches.push_back(patch);
              }
        }
  }

#define INSTANTIATE(dim)                                           \
  template void fill_material_points(const ParticleSet<dim> &,     \
                                     const NodeCloud<dim> &,       \
                                     const Occupancy<dim> &,       \
                                     SupportTable<dim> &);         \
  template void add_gauss_points(                                  \
    const NodeCloud<dim> &,                                        \
    const LinearAlgebra::distributed::Vector<double> &,            \
    GaussSupports<dim> &,                                          \
    SupportTable<dim> &);                                          \
  template void add_wall_points(const NodeCloud<dim> &,            \
                                const std::array<bool, 2 * dim> &, \
                                SupportTable<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
