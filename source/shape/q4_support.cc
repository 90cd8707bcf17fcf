#include <selkie/shape/gather_points.h>
#include <selkie/shape/lme.h>
#include <selkie/shape/q4_support.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/qprojector.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  Q4Support<dim>::Q4Support(const Scene<dim>     &scene,
                            const NodeCloud<dim> &cloud)
    : scene(scene)
    , cloud(cloud)
  {
    IndexSet relevant;
    DoFTools::extract_locally_relevant_dofs(cloud.dof_handler(), relevant);
    hanging.reinit(relevant);
    DoFTools::make_hanging_node_constraints(cloud.dof_handler(), hanging);
    hanging.close();
  }

  template <int dim>
  void
  Q4Support<dim>::append_nodes(Patch<dim>        &patch,
                               SupportTable<dim> &table) const
  {
    patch.first_node = table.nodes.size();
    const auto add   = [&](const unsigned int node) {
      const auto begin = table.nodes.begin() + patch.first_node;
      if (std::find(begin, table.nodes.end(), node) == table.nodes.end())
        table.nodes.push_back(node);
    };
    for (const unsigned int node : cloud.corners(patch.cell))
      {
        const auto *masters =
          hanging.get_constraint_entries(cloud.global_index(node));
        if (masters == nullptr)
          add(node);
        else
          for (const auto &[master, weight] : *masters)
            add(cloud.partitioner()->global_to_local(master));
      }
    patch.n_nodes  = table.nodes.size() - patch.first_node;
    patch.n_padded = lme_padded(patch.n_nodes);
    patch.data     = table.data.size();
    table.data.resize(patch.data + patch.n_points * (dim + 1) * patch.n_padded);
  }

  template <int dim>
  void
  Q4Support<dim>::evaluate(const Patch<dim>  &patch,
                           const unsigned int q,
                           const Point<dim>  &reference,
                           SupportTable<dim> &table) const
  {
    using Info               = GeometryInfo<dim>;
    constexpr unsigned int n = Info::vertices_per_cell;

    std::array<Tensor<1, dim>, n> gradients; // in the unit cell, then grad_0 N
    Tensor<2, dim>                jacobian;
    for (unsigned int v = 0; v < n; ++v)
      {
        gradients[v] = Info::d_linear_shape_function_gradient(reference, v);
        jacobian += outer_product(patch.cell->vertex(v), gradients[v]);
      }
    Tensor<2, dim> to_current = transpose(invert(jacobian));
    if (scene.lagrangian_mesh())
      to_current =
        transpose(invert(table.points[patch.first_point + q].F_n)) * to_current;

    double    *N     = const_cast<double *>(table.N(patch, q));
    const auto nodes = table.nodes.begin() + patch.first_node;
    const auto add   = [&](const unsigned int    node,
                         const double          value,
                         const Tensor<1, dim> &gradient) {
      const unsigned int k =
        std::find(nodes, nodes + patch.n_nodes, node) - nodes;
      N[k] += value;
      for (unsigned int d = 0; d < dim; ++d)
        N[(d + 1) * patch.n_padded + k] += gradient[d];
    };
    const auto corners = cloud.corners(patch.cell);
    for (unsigned int v = 0; v < n; ++v)
      {
        const double value    = Info::d_linear_shape_function(reference, v);
        const auto   gradient = to_current * gradients[v];
        const auto  *masters =
          hanging.get_constraint_entries(cloud.global_index(corners[v]));
        if (masters == nullptr)
          add(corners[v], value, gradient);
        else
          for (const auto &[master, weight] : *masters)
            add(cloud.partitioner()->global_to_local(master),
                weight * value,
                weight * gradient);
      }
  }

  namespace
  {
    /// Points of the classical MPM are taken to lie at least this far (in
    /// cells) from the faces of theirs: on a face, the hat functions of the
    /// corners off it are zero, and such a corner may have no mass at all.
    constexpr double face_margin = 1e-4;
  } // namespace

  template <int dim>
  void
  Q4Support<dim>::fill_points(const ParticleSet<dim> &particles,
                              SupportTable<dim>      &table) const
  {
    gather_points(particles, table);
    std::vector<Point<dim>> references;
    references.reserve(table.n_particles);
    for (const auto &particle : particles.handler())
      references.push_back(particle.get_reference_location());
    for (Patch<dim> &patch : table.patches)
      {
        append_nodes(patch, table);
        for (unsigned int q = 0; q < patch.n_points; ++q)
          {
            Point<dim> &reference =
              references[table.points[patch.first_point + q].particle];
            if (!scene.lagrangian_mesh())
              for (unsigned int d = 0; d < dim; ++d)
                reference[d] =
                  std::clamp(reference[d], face_margin, 1. - face_margin);
            evaluate(patch, q, reference, table);
          }
      }
  }

  namespace
  {
    /// Whether a face lies on the plane that a traction loads.
    template <int dim, typename Cell>
    bool
    is_loaded(const Scene<dim>    &scene,
              const Traction<dim> &traction,
              const Cell          &cell,
              const unsigned int   face)
    {
      const auto box       = scene.bodies[traction.body].shape->bounding_box();
      const unsigned int d = traction.face / 2;
      const double       plane =
        traction.face % 2 == 0 ? box.lower_bound(d) : box.upper_bound(d);
      const auto on_plane = [&](const unsigned int v) {
        return std::abs(cell->face(face)->vertex(v)[d] - plane) <
               1e-6 * cell->diameter();
      };
      for (unsigned int v = 0; v < GeometryInfo<dim>::vertices_per_face; ++v)
        if (!on_plane(v))
          return false;
      return true;
    }
  } // namespace

  template <int dim>
  void
  Q4Support<dim>::add_loaded_faces(const std::array<Vector, dim> &displacement,
                                   SupportTable<dim>             &table) const
  {
    if (scene.tractions.empty())
      return;
    static const QGauss<dim - 1> gauss(2);
    const unsigned int           n_cells = table.patches.size();
    for (unsigned int i = 0; i < n_cells; ++i)
      for (unsigned int face = 0; face < GeometryInfo<dim>::faces_per_cell;
           ++face)
        for (const Traction<dim> &traction : scene.tractions)
          {
            const Patch<dim> &of_cell = table.patches[i];
            StepPoint<dim>    point   = table.points[of_cell.first_point];
            if (point.body != traction.body ||
                !is_loaded(scene, traction, of_cell.cell, face))
              continue;

            Patch<dim> patch  = of_cell;
            patch.matter      = false;
            patch.integration = false;
            patch.fluid       = false;
            patch.pressure    = false;
            patch.surface     = true;
            patch.first_point = table.points.size();
            patch.n_points    = gauss.size();
            point.mass        = 0.;
            point.volume      = 0.;
            table.points.resize(patch.first_point + gauss.size(), point);
            append_nodes(patch, table);
            const auto points = QProjector<dim>::project_to_face(
              ReferenceCells::get_hypercube<dim>(), gauss, face);
            for (unsigned int q = 0; q < gauss.size(); ++q)
              {
                evaluate(patch, q, points.point(q), table);
                StepPoint<dim> &at = table.points[patch.first_point + q];
                at.X               = Point<dim>();
                Tensor<1, dim> u;
                const double  *N = table.N(patch, q);
                for (unsigned int k = 0; k < patch.n_nodes; ++k)
                  {
                    const unsigned int node = table.nodes[patch.first_node + k];
                    at.X += N[k] * cloud.position(node);
                    for (unsigned int d = 0; d < dim; ++d)
                      u[d] += N[k] * displacement[d].local_element(node);
                  }
                at.x    = at.X + u;
                at.area = gauss.weight(q) * patch.cell->face(face)->measure();
              }
            table.patches.push_back(patch);
          }
  }

  template <int dim>
  void
  Q4Support<dim>::interpolate_hanging(Vector &field) const
  {
    field.update_ghost_values();
    for (unsigned int node = 0; node < cloud.n_owned(); ++node)
      if (const auto *masters =
            hanging.get_constraint_entries(cloud.global_index(node)))
        {
          double value = 0.;
          for (const auto &[master, weight] : *masters)
            value += weight * field.local_element(
                                cloud.partitioner()->global_to_local(master));
          field.local_element(node) = value;
        }
    field.update_ghost_values();
  }

  template <int dim>
  Occupancy<dim>
  Q4Support<dim>::occupancy(const SupportTable<dim> &table) const
  {
    unsigned int n_phases = 0;
    for (const auto &body : scene.bodies)
      n_phases = std::max(n_phases, body.phase + 1);
    Occupancy<dim> result;
    result.active.assign(cloud.size(), 0);
    Vector mark(cloud.partitioner());
    for (unsigned int phase = 0; phase < n_phases; ++phase)
      {
        mark = 0.;
        for (const auto &patch : table.patches)
          if (patch.phase == phase)
            for (unsigned int k = 0; k < patch.n_nodes; ++k)
              mark.local_element(table.nodes[patch.first_node + k]) = 1.;
        mark.compress(VectorOperation::max);
        mark.update_ghost_values();
        for (unsigned int node = 0; node < cloud.size(); ++node)
          if (mark.local_element(node) > 0.)
            result.active[node] |= 1u << phase;
        mark.zero_out_ghost_values();
      }
    return result;
  }

  template class Q4Support<2>;
  template class Q4Support<3>;
} // namespace selkie
