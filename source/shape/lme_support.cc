#include <selkie/laws/fluid_law.h>
#include <selkie/shape/gather_points.h>
#include <selkie/shape/lme.h>
#include <selkie/shape/lme_support.h>

#include <deal.II/base/quadrature_lib.h>

#include <algorithm>

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
      table.data.resize_fast(patch.data +
                             patch.n_points * (dim + 1) * patch.n_padded);
      for (unsigned int q = 0; q < patch.n_points; ++q)
        {
          StepPoint<dim>    &point = table.points[patch.first_point + q];
          double            *N     = const_cast<double *>(table.N(patch, q));
          const unsigned int iterations =
            lme_evaluate(nodes, point.x, point.lambda, N, N + patch.n_padded);
          table.newton_iterations += iterations;
          table.max_newton_iterations =
            std::max(table.max_newton_iterations, iterations);
        }
    }

    template <int dim>
    bool
    is_full(const NodeCloud<dim>    &cloud,
            const Occupancy<dim>    &occupancy,
            const SupportTable<dim> &table,
            const Patch<dim>        &patch)
    {
      if (!patch.fluid || occupancy.enclosed.empty())
        return false;
      // Beside hanging nodes the sums over Gauss points and over material
      // points differ too much.
      if (!cloud.equally_spaced(&table.nodes[patch.first_node], patch.n_nodes))
        return false;
      const auto corners = cloud.corners(patch.cell);
      return std::all_of(corners.begin(), corners.end(), [&](const auto node) {
        return occupancy.enclosed[node];
      });
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
    for (Patch<dim> &patch : table.patches)
      {
        append_nodes(cloud, occupancy, patch, table);
        patch.integration = !is_full(cloud, occupancy, table, patch);
        evaluate_patch(cloud, patch, table);
      }
  }

  template <int dim>
  void
  add_gauss_points(
    const ParticleSet<dim>                           &particles,
    const NodeCloud<dim>                             &cloud,
    const LinearAlgebra::distributed::Vector<double> &nodal_pressure,
    SupportTable<dim>                                &table)
  {
    (void)particles;
    static const QGauss<dim> gauss(2);
    const unsigned int       n_matter = table.patches.size();
    for (unsigned int i = 0; i < n_matter; ++i)
      if (!table.patches[i].integration)
        {
          Patch<dim> patch  = table.patches[i]; // same cell, same nodes
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
          evaluate_patch(cloud, patch, table);

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

#define INSTANTIATE(dim)                                       \
  template void fill_material_points(const ParticleSet<dim> &, \
                                     const NodeCloud<dim> &,   \
                                     const Occupancy<dim> &,   \
                                     SupportTable<dim> &);     \
  template void add_gauss_points(                              \
    const ParticleSet<dim> &,                                  \
    const NodeCloud<dim> &,                                    \
    const LinearAlgebra::distributed::Vector<double> &,        \
    SupportTable<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
