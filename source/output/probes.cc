#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/output/audit.h>
#include <selkie/output/probes.h>
#include <selkie/scene/check_scene.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/mpi.templates.h> // all_reduce of own types

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace selkie
{
  namespace
  {
    /// A vector of the plane or of space, in space.
    template <int dim>
    dealii::Tensor<1, 3>
    in_space(const dealii::Tensor<1, dim> &a)
    {
      dealii::Tensor<1, 3> result;
      for (unsigned int i = 0; i < dim; ++i)
        result[i] = a[i];
      return result;
    }

    template <int dim>
    dealii::Tensor<1, dim>
    not_a_number()
    {
      dealii::Tensor<1, dim> result;
      for (unsigned int i = 0; i < dim; ++i)
        result[i] = std::numeric_limits<double>::quiet_NaN();
      return result;
    }

    /// Whether some points of a probe of kind `point` or `region` may have a
    /// pressure. Told from the scene, so that a curve has the same columns when
    /// these points have left.
    template <int dim>
    bool
    may_have_pressure(const Probe<dim> &probe, const Scene<dim> &scene)
    {
      const auto &[lower, upper] =
        probe.kind == Probe<dim>::Kind::region
          ? probe.shape->bounding_box().get_boundary_points()
          : std::make_pair(probe.position, probe.position);
      for (const auto &body : scene.bodies)
        {
          bool       common = body.has_pressure;
          const auto box    = body.shape->bounding_box();
          for (unsigned int i = 0; i < dim; ++i)
            common = common && lower[i] <= box.upper_bound(i) &&
                     upper[i] >= box.lower_bound(i);
          if (common)
            return true;
        }
      return false;
    }
  } // namespace

  template <int dim>
  Probes<dim>::Sums::Sums()
  {
    for (unsigned int i = 0; i < dim; ++i)
      {
        lower[i] = std::numeric_limits<double>::infinity();
        upper[i] = -std::numeric_limits<double>::infinity();
      }
  }


  template <int dim>
  void
  Probes<dim>::Sums::add(const Sums &other)
  {
    weight += other.weight;
    mass += other.mass;
    volume += other.volume;
    wet += other.wet;
    pressure += other.pressure;
    x += other.x;
    u += other.u;
    v += other.v;
    mx += other.mx;
    mxx += other.mxx;
    for (unsigned int i = 0; i < dim; ++i)
      {
        lower[i] = std::min(lower[i], other.lower[i]);
        upper[i] = std::max(upper[i], other.upper[i]);
      }
  }


  template <int dim>
  Probes<dim>::Probes(const Scene<dim>       &scene,
                      const ParticleSet<dim> &particles,
                      const std::string      &directory,
                      const double            interval)
    : particles(particles)
    , seconds(interval)
  {
    using Kind = typename Probe<dim>::Kind;
    const auto rank =
      dealii::Utilities::MPI::this_mpi_process(particles.communicator());
    for (const Probe<dim> &probe : scene.probes)
      {
        curves.emplace_back();
        Curve &curve = curves.back();
        curve.probe  = &probe;
        if (probe.kind == Kind::point)
          curve.radius = radius_that_reaches(probe);
        curve.with_pressure =
          (probe.kind == Kind::point || probe.kind == Kind::region) &&
          may_have_pressure(probe, scene);
        fail_together<OutputError>(particles.communicator(), [&] {
          curve.table.open(directory + "/probes/" + probe.name + ".csv",
                           rank == 0);
        });
      }
  }


  /// The probe's own radius, or the distance to the nearest points when it
  /// reaches none: 1e-6 further, so that equally near points all count.
  template <int dim>
  double
  Probes<dim>::radius_that_reaches(const Probe<dim> &probe) const
  {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto &point : particles.handler())
      {
        const auto X = particles.columns.X(point.get_properties());
        nearest      = std::min(nearest, (X - probe.position).norm());
      }
    nearest = dealii::Utilities::MPI::min(nearest, particles.communicator());
    return std::max(probe.radius, (1. + 1e-6) * nearest);
  }


  template <int dim>
  bool
  Probes<dim>::selects(const Curve                           &curve,
                       const dealii::ArrayView<const double> &properties) const
  {
    using Kind                = typename Probe<dim>::Kind;
    const Probe<dim> &probe   = *curve.probe;
    const auto       &columns = particles.columns;
    switch (probe.kind)
      {
        case Kind::point:
          return (columns.X(properties) - probe.position).norm() <=
                 curve.radius;
        case Kind::region:
          return probe.shape->contains(
            dealii::Point<dim>(columns.X(properties)));
        case Kind::front:
        case Kind::extent:
          return columns.body(properties) == probe.body;
        case Kind::node:
        case Kind::wall_force:
        case Kind::wall_pressure:
        case Kind::height:
        case Kind::body_force:
        case Kind::error:
          return false;
      }
    return false;
  }


  template <int dim>
  typename Probes<dim>::Sums
  Probes<dim>::sums_of_point(
    const dealii::Particles::ParticleAccessor<dim> &point) const
  {
    const auto  properties = point.get_properties();
    const auto &columns    = particles.columns;
    Sums        sums;
    // Means are those of the matter, however finely it is cut into points.
    sums.weight = columns.volume(properties);
    sums.mass   = columns.mass(properties);
    sums.volume =
      columns.volume(properties) * volume_ratio(particles, properties);
    const auto x = point.get_location();
    sums.lower = sums.upper = x;
    sums.x                  = sums.weight * x;
    sums.mx                 = sums.mass * x;
    for (unsigned int i = 0; i < dim; ++i)
      sums.mxx[i] = sums.mx[i] * x[i];
    if (columns.X.exists())
      sums.u = sums.weight * (x - columns.X(properties));
    if (columns.v.exists())
      sums.v = sums.weight * columns.v(properties);
    const unsigned int body = columns.body(properties);
    if (particles.scene.bodies[body].has_pressure)
      {
        sums.wet      = sums.weight;
        sums.pressure = sums.weight * columns.pressure(properties);
      }
    return sums;
  }


  template <int dim>
  std::vector<typename Probes<dim>::Sums>
  Probes<dim>::sums_of_curves() const
  {
    std::vector<Sums> of_curves(curves.size());
    for (const auto &point : particles.handler())
      for (unsigned int c = 0; c < curves.size(); ++c)
        if (selects(curves[c], point.get_properties()))
          of_curves[c].add(sums_of_point(point));

    for (Sums &sums : of_curves)
      sums = dealii::Utilities::MPI::all_reduce<Sums>(
        sums, particles.communicator(), [](const Sums &a, const Sums &b) {
          Sums both = a;
          both.add(b);
          return both;
        });
    return of_curves;
  }


  template <int dim>
  void
  Probes<dim>::set_means(const Sums &sums, Statistics &table) const
  {
    for (unsigned int i = 0; i < dim; ++i)
      table.set(component_column("displacement", i, "m"),
                sums.u[i] / sums.weight);
    for (unsigned int i = 0; i < dim; ++i)
      table.set(component_column("position", i, "m"), sums.x[i] / sums.weight);
    if (particles.columns.v.exists())
      for (unsigned int i = 0; i < dim; ++i)
        table.set(component_column("velocity", i, "m/s"),
                  sums.v[i] / sums.weight);
  }


  template <int dim>
  void
  Probes<dim>::set_extent(const Sums &sums, Statistics &table)
  {
    table.set(dim == 2 ? "volume (m^2)" : "volume (m^3)", sums.volume);
    for (unsigned int i = 0; i < dim; ++i)
      {
        // The variance of a coordinate is a^2 / (dim + 2) in an ellipsoid.
        const double center   = sums.mx[i] / sums.mass;
        const double variance = sums.mxx[i] / sums.mass - center * center;
        table.set(component_column("min", i, "m"), sums.lower[i]);
        table.set(component_column("max", i, "m"), sums.upper[i]);
        table.set(component_column("center", i, "m"), center);
        table.set(component_column("semi-axis", i, "m"),
                  std::sqrt((dim + 2) * std::max(variance, 0.)));
      }
  }


  template <int dim>
  void
  Probes<dim>::set_node(const Probe<dim>      &probe,
                        const NodeMotion<dim> &nodes,
                        Statistics            &table) const
  {
    if (nodes.displacement == nullptr)
      throw SceneError("the probe '" + probe.name + "' is that of a node");
    // Where several are equally near: the one of the smallest global number.
    using dealii::Utilities::MPI::min;
    using dealii::Utilities::MPI::sum;
    const MPI_Comm comm    = particles.communicator();
    double         nearest = std::numeric_limits<double>::max();
    for (unsigned int i = 0; i < nodes.cloud->n_owned(); ++i)
      nearest =
        std::min(nearest, nodes.cloud->position(i).distance(probe.position));
    nearest         = (1. + 1e-9) * min(nearest, comm);
    const auto none = nodes.cloud->n_global();
    auto       best = none;
    unsigned   mine = 0;
    for (unsigned int i = 0; i < nodes.cloud->n_owned(); ++i)
      if (nodes.cloud->position(i).distance(probe.position) <= nearest &&
          nodes.cloud->global_index(i) < best)
        {
          best = nodes.cloud->global_index(i);
          mine = i;
        }
    dealii::Tensor<1, dim> u, x, v;
    if (min(best, comm) == best) // a node has one owner
      for (unsigned int d = 0; d < dim; ++d)
        {
          u[d] = (*nodes.displacement)[d].local_element(mine);
          v[d] = (*nodes.velocity)[d].local_element(mine);
          x[d] = nodes.cloud->position(mine)[d] + u[d];
        }
    Sums node;
    node.weight = 1;
    node.u      = sum(u, comm);
    node.x      = sum(x, comm);
    node.v      = sum(v, comm);
    set_means(node, table);
  }


  template <int dim>
  void
  Probes<dim>::set_force(const Probe<dim>             &probe,
                         const dealii::Tensor<1, dim> &force,
                         const dealii::Tensor<1, 3>   &moment_about_origin,
                         Statistics                   &table) const
  {
    for (unsigned int i = 0; i < dim; ++i)
      table.set(component_column("force", i, dim == 2 ? "N/m" : "N"), force[i]);
    const auto moment =
      moment_about_origin -
      dealii::cross_product_3d(in_space(probe.position), in_space(force));
    for (unsigned int i = (dim == 2 ? 2 : 0); i < 3; ++i)
      table.set(component_column("moment", i, dim == 2 ? "N" : "N m"),
                moment[i]);
  }


  template <int dim>
  void
  Probes<dim>::set_body_force(const Probe<dim> &probe, Statistics &table) const
  {
    const auto            &columns = particles.columns;
    const auto            &gravity = particles.scene.gravity;
    dealii::Tensor<1, dim> force;
    dealii::Tensor<1, 3>   moment;
    for (const auto &point : particles.handler())
      {
        const auto properties = point.get_properties();
        if (columns.body(properties) != probe.body)
          continue;
        dealii::Tensor<1, dim> F = columns.a(properties);
        if (gravity)
          F -= *gravity;
        F *= columns.mass(properties);
        force += F;
        moment +=
          dealii::cross_product_3d(in_space(point.get_location()), in_space(F));
      }
    const MPI_Comm comm = particles.communicator();
    set_force(probe,
              dealii::Utilities::MPI::sum(force, comm),
              dealii::Utilities::MPI::sum(moment, comm),
              table);
  }


  template <int dim>
  void
  Probes<dim>::set_height(const Probe<dim> &probe, Statistics &table) const
  {
    const double radius =
      probe.radius > 0. ? probe.radius : cell_size(particles.scene.domain);
    double height = -std::numeric_limits<double>::infinity();
    for (const auto &point : particles.handler())
      {
        if (particles.columns.body(point.get_properties()) != probe.body)
          continue;
        auto away        = point.get_location() - probe.position;
        away[probe.axis] = 0.;
        if (away.norm() <= radius)
          height = std::max(height, point.get_location()[probe.axis]);
      }
    height = dealii::Utilities::MPI::max(height, particles.communicator());
    table.set(component_column("height", probe.axis, "m"),
              std::isfinite(height) ? height
                                    : std::numeric_limits<double>::quiet_NaN());
  }


  template <int dim>
  void
  Probes<dim>::set_wall_pressure(const Probe<dim>      &probe,
                                 const NodeMotion<dim> &nodes,
                                 Statistics            &table) const
  {
    const auto            gauge = probe.shape->bounding_box();
    const unsigned int    d     = probe.wall / 2;
    std::array<double, 3> sums{}; // area, area of the wet part, force
    double                largest = 0.;
    for (const auto &cell :
         nodes.cloud->dof_handler().get_triangulation().active_cell_iterators())
      {
        if (!cell->is_locally_owned() || !cell->at_boundary(probe.wall))
          continue;
        const auto         box  = cell->bounding_box();
        double             area = 1.;
        dealii::Point<dim> middle; // of what the face shares with the gauge
        for (unsigned int i = 0; i < dim; ++i)
          if (i == d)
            middle[i] =
              probe.wall % 2 == 0 ? box.lower_bound(i) : box.upper_bound(i);
          else
            {
              const double from =
                std::max(box.lower_bound(i), gauge.lower_bound(i));
              const double to =
                std::min(box.upper_bound(i), gauge.upper_bound(i));
              area *= std::max(0., to - from);
              middle[i] = 0.5 * (from + to);
            }
        if (area <= 0.)
          continue;
        // The middle's value is the mean of what is linear along the edges.
        const auto corners = nodes.cloud->corners(cell);
        const auto unit    = box.real_to_unit(middle);
        double     p = 0., wet = 0.;
        for (unsigned int v = 0; v < corners.size(); ++v)
          {
            const double value = nodes.pressure->local_element(corners[v]);
            if (std::isnan(value))
              continue;
            const double hat =
              dealii::GeometryInfo<dim>::d_linear_shape_function(unit, v);
            p += hat * value;
            wet += hat;
          }
        sums[0] += area;
        sums[1] += area * wet;
        sums[2] += area * p;
        largest = std::max(largest, p);
      }
    const MPI_Comm comm = particles.communicator();
    for (double &sum : sums)
      sum = dealii::Utilities::MPI::sum(sum, comm);
    table.set("mean pressure (Pa)", sums[2] / sums[0]);
    table.set("largest pressure (Pa)",
              dealii::Utilities::MPI::max(largest, comm));
    table.set("wet share", sums[1] / sums[0]);
  }


  template <int dim>
  void
  Probes<dim>::set_error(const Probe<dim> &probe,
                         const double      time,
                         Statistics       &table) const
  {
    const bool  of_velocity = probe.quantity == Probe<dim>::Quantity::velocity;
    const auto &columns     = particles.columns;
    std::array<double, 3> sums{}; // of volume, squared error, squared function
    double                largest = 0.;
    for (const auto &point : particles.handler())
      {
        const auto properties = point.get_properties();
        if (columns.body(properties) != probe.body)
          continue;
        const auto                   x = point.get_location();
        const dealii::Point<dim>     X(columns.X(properties));
        const dealii::Tensor<1, dim> value =
          of_velocity ? columns.v(properties) : x - X;
        const auto   exact  = probe.function->value(x, time, X);
        const double V      = columns.volume(properties);
        const double square = (value - exact).norm_square();
        sums[0] += V;
        sums[1] += V * square;
        sums[2] += V * exact.norm_square();
        largest = std::max(largest, std::sqrt(square));
      }
    const MPI_Comm comm = particles.communicator();
    for (double &sum : sums)
      sum = dealii::Utilities::MPI::sum(sum, comm);
    largest = dealii::Utilities::MPI::max(largest, comm);

    const std::string unit = of_velocity ? " (m/s)" : " (m)";
    table.set("L2 error" + unit, std::sqrt(sums[1] / sums[0]));
    table.set("largest error" + unit, largest);
    table.set("L2 norm of the function" + unit, std::sqrt(sums[2] / sums[0]));
  }


  template <int dim>
  void
  Probes<dim>::record(const double           time,
                      const WallForces<dim> &walls,
                      const NodeMotion<dim> &nodes)
  {
    if (curves.empty())
      return;
    using Kind = typename Probe<dim>::Kind;
    if (particles.scene.adaptivity) // points come and go
      for (Curve &curve : curves)
        if (curve.probe->kind == Kind::point)
          curve.radius = radius_that_reaches(*curve.probe);
    const std::vector<Sums> sums = sums_of_curves();
    for (unsigned int c = 0; c < curves.size(); ++c)
      {
        const Probe<dim> &probe = *curves[c].probe;
        Statistics       &table = curves[c].table;
        table.set("time (s)", time);
        switch (probe.kind)
          {
            case Kind::point:
            case Kind::region:
              set_means(sums[c], table);
              if (curves[c].with_pressure)
                table.set("pressure (Pa)",
                          sums[c].wet > 0. ? sums[c].pressure / sums[c].wet
                                           : 0.);
              break;
            case Kind::node:
              set_node(probe, nodes, table);
              break;
            case Kind::wall_force:
              if (probe.wall < walls.moment.size())
                set_force(probe,
                          walls.force[probe.wall],
                          walls.moment[probe.wall],
                          table);
              else
                set_force(probe, not_a_number<dim>(), not_a_number<3>(), table);
              break;
            case Kind::wall_pressure:
              set_wall_pressure(probe, nodes, table);
              break;
            case Kind::height:
              set_height(probe, table);
              break;
            case Kind::body_force:
              set_body_force(probe, table);
              break;
            case Kind::front:
              table.set(component_column("front", probe.axis, "m"),
                        sums[c].upper[probe.axis]);
              table.set(component_column("rear", probe.axis, "m"),
                        sums[c].lower[probe.axis]);
              break;
            case Kind::extent:
              set_extent(sums[c], table);
              break;
            case Kind::error:
              set_error(probe, time, table);
              break;
          }
        fail_together<OutputError>(particles.communicator(),
                                   [&] { table.end_row(); });
      }
  }


  template class Probes<2>;
  template class Probes<3>;
} // namespace selkie
