#include <selkie/base/types.h>
#include <selkie/shape/contact_pairs.h>
#include <selkie/shape/lme.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// What the nodes at shared vertices know of the matter of their layer.
    template <int dim>
    struct NodeMatter
    {
      std::vector<bool>       shared;  ///< another layer is active there
      Vector                  mass;    ///< sum m N (kg)
      std::array<Vector, dim> outward; ///< sum V grad N (m^(dim-1))
      std::vector<Vector>     extent;  ///< towards the matter of each layer (m)

      /// From the matter of node a to that of node b; zero if not defined.
      Tensor<1, dim>
      normal(const unsigned int a, const unsigned int b) const
      {
        Tensor<1, dim> n;
        double         size = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double of_a = outward[d].local_element(a);
            const double of_b = outward[d].local_element(b);
            n[d]              = of_a - of_b;
            size += std::abs(of_a) + std::abs(of_b);
          }
        return n.norm() > 1e-6 * size ? n / n.norm() : Tensor<1, dim>();
      }
    };

    /// False if no node is, on any rank.
    template <int dim>
    bool
    find_shared(const NodeCloud<dim> &cloud,
                const Occupancy<dim> &occupancy,
                std::vector<bool>    &shared)
    {
      bool any = false;
      shared.assign(cloud.size(), false);
      for (unsigned int node = 0; node < cloud.size(); ++node)
        for (unsigned int layer = 0; layer < cloud.n_layers(); ++layer)
          if (layer != cloud.layer(node) && occupancy.active[node] != 0 &&
              occupancy.active[cloud.in_layer(node, layer)] != 0)
            any = shared[node] = true;
      return Utilities::MPI::max(any ? 1 : 0,
                                 cloud.partitioner()->get_mpi_communicator()) ==
             1;
    }

    /// Calls see(patch, q, k, node) for the points' nodes at shared vertices.
    template <int dim, typename See>
    void
    for_each_shared(const SupportTable<dim> &table,
                    const std::vector<bool> &shared,
                    const See               &see)
    {
      for (const auto &patch : table.patches)
        if (patch.matter)
          for (unsigned int k = 0; k < patch.n_nodes; ++k)
            if (const unsigned int node = table.nodes[patch.first_node + k];
                shared[node])
              for (unsigned int q = 0; q < patch.n_points; ++q)
                see(patch, q, k, node);
    }

    template <int dim>
    double
    volume_of(const StepPoint<dim> &point)
    {
      return point.volume * (point.law->phase() == Phase::fluid
                               ? point.J_n
                               : determinant(point.F_n));
    }

    template <int dim>
    void
    sum_matter(const NodeCloud<dim>    &cloud,
               const SupportTable<dim> &table,
               NodeMatter<dim>         &matter)
    {
      matter.mass.reinit(cloud.partitioner());
      for (auto &component : matter.outward)
        component.reinit(cloud.partitioner());
      for_each_shared(table,
                      matter.shared,
                      [&](const Patch<dim>  &patch,
                          const unsigned int q,
                          const unsigned int k,
                          const unsigned int node) {
                        const auto &point = table.points[patch.first_point + q];
                        const double V    = volume_of(point);
                        matter.mass.local_element(node) +=
                          point.mass * table.N(patch, q)[k];
                        for (unsigned int d = 0; d < dim; ++d)
                          matter.outward[d].local_element(node) +=
                            V * table.gradient(patch, q, d)[k];
                      });
      const auto share = [](Vector &vector) {
        vector.compress(VectorOperation::add);
        vector.update_ghost_values();
      };
      share(matter.mass);
      for (auto &component : matter.outward)
        share(component);
    }

    /// How far the matter of each node's layer reaches from the vertex towards
    /// that of the others.
    template <int dim>
    void
    find_extents(const NodeCloud<dim>    &cloud,
                 const SupportTable<dim> &table,
                 NodeMatter<dim>         &matter)
    {
      matter.extent.resize(cloud.n_layers());
      for (auto &extent : matter.extent)
        {
          extent.reinit(cloud.partitioner());
          for (unsigned int node = 0; node < cloud.size(); ++node)
            extent.local_element(node) = std::numeric_limits<double>::lowest();
        }
      for_each_shared(
        table,
        matter.shared,
        [&](const Patch<dim>  &patch,
            const unsigned int q,
            const unsigned int /*k*/,
            const unsigned int node) {
          const auto          &point = table.points[patch.first_point + q];
          const Tensor<1, dim> r     = point.x - cloud.position(node);
          for (unsigned int d = 0; d < dim; ++d)
            if (std::abs(r[d]) > cloud.spacing(node))
              return; // behind what stands in the cells around the vertex
          const double half = 0.5 * std::pow(volume_of(point), 1. / dim);
          for (unsigned int layer = 0; layer < cloud.n_layers(); ++layer)
            if (layer != cloud.layer(node))
              {
                const auto n = matter.normal(node, cloud.in_layer(node, layer));
                double    &extent = matter.extent[layer].local_element(node);
                extent            = std::max(extent, r * n + half);
              }
        });
      for (auto &extent : matter.extent)
        extent.compress(VectorOperation::max);
    }

    /// The pair of nodes a and b at a corner of the cell.
    template <int dim>
    void
    add_pair(const NodeCloud<dim>           &cloud,
             const NodeMatter<dim>          &matter,
             const typename Patch<dim>::Cell cell,
             const unsigned int              a,
             const unsigned int              b,
             SupportTable<dim>              &table)
    {
      const Tensor<1, dim> n = matter.normal(a, b);
      if (n == Tensor<1, dim>())
        return;
      Patch<dim> patch;
      patch.matter = patch.integration = false;
      patch.contact                    = true;
      patch.cell                       = cell;
      patch.first_point                = table.points.size();
      patch.n_points                   = 1;
      patch.first_node                 = table.nodes.size();
      patch.n_nodes                    = 2;
      patch.n_padded                   = lme_padded(2);
      patch.data                       = table.data.size();
      table.nodes.insert(table.nodes.end(), {a, b});
      table.data.resize(patch.data + (dim + 1) * patch.n_padded);
      double *N = table.data.data() + patch.data;
      N[0]      = 1.;
      N[1]      = -1.;
      for (unsigned int d = 0; d < dim; ++d)
        {
          N[(d + 1) * patch.n_padded]     = n[d];
          N[(d + 1) * patch.n_padded + 1] = -n[d];
        }
      StepPoint<dim> point;
      const double   m_a = matter.mass.local_element(a);
      const double   m_b = matter.mass.local_element(b);
      point.x            = cloud.position(a);
      point.mass         = m_a * m_b / (m_a + m_b);
      point.area         = -(matter.extent[cloud.layer(b)].local_element(a) +
                     matter.extent[cloud.layer(a)].local_element(b));
      table.points.push_back(point);
      table.patches.push_back(patch);
    }
  } // namespace

  template <int dim>
  void
  add_contact_pairs(const NodeCloud<dim> &cloud,
                    const Occupancy<dim> &occupancy,
                    SupportTable<dim>    &table)
  {
    NodeMatter<dim> matter;
    if (!find_shared(cloud, occupancy, matter.shared))
      return;
    sum_matter(cloud, table, matter);
    find_extents(cloud, table, matter);
    std::vector<bool> done(cloud.n_owned(), false);
    for (const auto &cell : cloud.dof_handler().active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int vertex : cloud.corners(cell))
          if (vertex < cloud.n_owned() && !done[vertex])
            {
              done[vertex] = true;
              for (unsigned int l = 0; l < cloud.n_layers(); ++l)
                for (unsigned int m = l + 1; m < cloud.n_layers(); ++m)
                  if (occupancy.active[vertex + l] != 0 &&
                      occupancy.active[vertex + m] != 0)
                    add_pair(
                      cloud, matter, cell, vertex + l, vertex + m, table);
            }
  }


  template <int dim>
  void
  remove_contact_pairs(SupportTable<dim> &table)
  {
    auto &patches = table.patches;
    patches.erase(std::remove_if(patches.begin(),
                                 patches.end(),
                                 [](const auto &patch) {
                                   return patch.contact;
                                 }),
                  patches.end());
  }

#define INSTANTIATE(dim)                                  \
  template void add_contact_pairs(const NodeCloud<dim> &, \
                                  const Occupancy<dim> &, \
                                  SupportTable<dim> &);   \
  template void remove_contact_pairs(SupportTable<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
