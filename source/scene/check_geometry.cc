#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/primitives.h>

#include <deal.II/base/bounding_box.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    std::string
    in_words(const BoundingBox<dim> &box)
    {
      std::ostringstream text;
      text << "(" << box.get_boundary_points().first << ") to ("
           << box.get_boundary_points().second << ")";
      return text.str();
    }


    template <int dim>
    BoundingBox<dim>
    box_of(const Domain<dim> &domain)
    {
      return BoundingBox<dim>({domain.lower, domain.upper});
    }


    template <int dim>
    void
    check_domain(const Scene<dim> &scene)
    {
      const Domain<dim> &domain = scene.domain;
      for (unsigned int d = 0; d < dim; ++d)
        if (!(domain.lower[d] < domain.upper[d]))
          fail(scene,
               "Domain/Upper corner",
               "every coordinate must be larger than that of 'Domain/Lower "
               "corner'");
      const double h = cell_size(domain);
      // LME functions are round; finite elements may be slender.
      for (unsigned int d = 0; d < dim && !scene.lagrangian_mesh(); ++d)
        {
          const double side =
            (domain.upper[d] - domain.lower[d]) / domain.cells[d];
          if (side > 1.01 * h)
            {
              std::ostringstream why;
              why << "the cells are " << h << " m by " << side
                  << " m; allowed are squares or cubes, to within 1 %";
              fail(scene, "Domain/Cells", why.str());
            }
        }
      for (const auto &refinement : domain.refinements)
        if (!refinement.shape)
          fail(scene,
               "Domain/Refinements/" + refinement.name + "/Shape",
               "the refinement needs a shape");
    }


    /// Extent of the finest cells, m.
    template <int dim>
    Tensor<1, dim>
    finest_cell(const Domain<dim> &domain)
    {
      unsigned int levels = 0;
      for (const auto &refinement : domain.refinements)
        levels = std::max(levels, refinement.levels);
      Tensor<1, dim> h = domain.upper - domain.lower;
      for (unsigned int d = 0; d < dim; ++d)
        h[d] /= domain.cells[d] * std::pow(2., levels);
      return h;
    }


    /// Whether check(x) holds for a point of the lattice
    /// origin + (i + offset) spacing in the box.
    template <int dim, typename Check>
    bool
    any_of_lattice(const BoundingBox<dim> &box,
                   const Point<dim>       &origin,
                   const Tensor<1, dim>   &spacing,
                   const double            offset,
                   const Check            &check)
    {
      long first[3] = {0, 0, 0}, last[3] = {0, 0, 0};
      for (unsigned int d = 0; d < dim; ++d)
        {
          first[d] = std::ceil((box.lower_bound(d) - origin[d]) / spacing[d] -
                               offset - 1e-9);
          last[d]  = std::floor((box.upper_bound(d) - origin[d]) / spacing[d] -
                               offset + 1e-9);
        }
      for (long k = first[2]; k <= last[2]; ++k)
        for (long j = first[1]; j <= last[1]; ++j)
          for (long i = first[0]; i <= last[0]; ++i)
            {
              const long index[3] = {i, j, k};
              Point<dim> x        = origin;
              for (unsigned int d = 0; d < dim; ++d)
                x[d] += (index[d] + offset) * spacing[d];
              if (check(x))
                return true;
            }
      return false;
    }


    template <int dim>
    void
    check_body(const Scene<dim> &scene, const Body<dim> &body)
    {
      const std::string path = "Bodies/" + body.name + "/Shape";
      if (!body.shape)
        fail(scene, path, "the body needs a shape");
      if (body.initial_displacement && scene.lagrangian_mesh())
        fail(scene,
             "Bodies/" + body.name + "/Initial displacement",
             "it moves material points, and with 'Approximation' = 'q4 fem' "
             "the mesh would stay; allowed is a body of the displaced shape");
      if (body.initial_displacement && body.phase != 0)
        fail(scene,
             "Bodies/" + body.name + "/Initial displacement",
             "allowed is one of a fluid only: a solid would be strained");
      if (body.initial_pressure && body.phase != 0)
        fail(scene,
             "Bodies/" + body.name + "/Initial pressure",
             "allowed is one of a fluid only: a solid's is that of its strain");
      const auto   domain    = box_of(scene.domain);
      const auto   box       = body.shape->bounding_box();
      const double tolerance = 1e-9 * cell_size(scene.domain);
      for (unsigned int d = 0; d < dim; ++d)
        if (box.lower_bound(d) < domain.lower_bound(d) - tolerance ||
            box.upper_bound(d) > domain.upper_bound(d) + tolerance)
          fail(scene,
               path,
               "the body '" + body.name + "' reaches outside the domain: it " +
                 "covers " + in_words(box) + ", allowed is " +
                 in_words(domain));
      if (scene.domain.mesh) // its cells are found when bodies are seeded
        return;
      const Tensor<1, dim> spacing =
        finest_cell(scene.domain) / double(body.points_per_direction);
      const bool has_points = any_of_lattice(
        box, scene.domain.lower, spacing, 0.5, [&](const Point<dim> &x) {
          return body.shape->contains(x);
        });
      if (!has_points || body.shape->volume() <= 0)
        fail(scene,
             path,
             "the body '" + body.name +
               "' is so small that it gets no material point; it needs finer "
               "cells or more points per direction");
    }


    /// On the lattice at which material points are seeded.
    template <int dim>
    void
    check_overlap(const Scene<dim> &scene,
                  const Body<dim>  &a,
                  const Body<dim>  &b)
    {
      BoundingBox<dim> common;
      if (!overlap(a.shape->bounding_box(), b.shape->bounding_box(), common))
        return;
      const Tensor<1, dim> spacing =
        finest_cell(scene.domain) /
        double(std::max(a.points_per_direction, b.points_per_direction));
      Point<dim> where;
      const bool overlap = any_of_lattice(
        common, scene.domain.lower, spacing, 0.5, [&](const Point<dim> &x) {
          where = x;
          return well_inside(*a.shape, x, 1e-6 * spacing[0]) &&
                 well_inside(*b.shape, x, 1e-6 * spacing[0]);
        });
      if (overlap)
        {
          std::ostringstream why;
          why << "the bodies '" << a.name << "' and '" << b.name
              << "' overlap, for example at (" << where
              << "); allowed are bodies that at most touch";
          fail(scene, "Bodies/" + b.name + "/Shape", why.str());
        }
    }


    /// Velocities of walls and node sets go with the condition 'prescribed',
    /// and that with the effect that allows it.
    template <int dim>
    void
    check_conditions(const Scene<dim> &scene)
    {
      bool       moves = false;
      const auto check = [&](const NodeCondition condition,
                             const bool          has_velocity,
                             const std::string  &velocity_path,
                             const std::string  &condition_path) {
        const bool prescribed = (condition == NodeCondition::prescribed);
        if (prescribed && !has_velocity)
          fail(scene,
               velocity_path,
               "a prescribed motion needs a velocity, one function per "
               "component, separated by semicolons");
        if (!prescribed && has_velocity)
          fail(scene,
               condition_path,
               "a velocity is given, so allowed is only 'prescribed'");
        moves = moves || prescribed || condition == NodeCondition::moving;
      };
      const auto names = wall_names<dim>();
      for (unsigned int w = 0; w < names.size(); ++w)
        check(scene.domain.walls[w].condition,
              scene.domain.walls[w].velocity != nullptr,
              "Domain/Walls/" + names[w] + " velocity",
              "Domain/Walls/" + names[w]);
      for (const auto &set : scene.node_sets)
        {
          const std::string path = "Node sets/" + set.name;
          check(set.condition,
                set.velocity != nullptr,
                path + "/Velocity",
                path + "/Condition");
          if ((set.condition == NodeCondition::moving) != (set.path != nullptr))
            fail(scene,
                 path + "/Path",
                 "a path goes with the condition 'moving', and that with a "
                 "path");
        }
      if (moves && !scene.has_effect("prescribed motion"))
        fail(
          scene,
          "Effects",
          "a wall or a node set is 'prescribed' or 'moving'; that needs the effect "
          "'prescribed motion'");
    }
  } // namespace


  template <int dim>
  void
  check_mesh_source(const Scene<dim> &scene)
  {
    const ImportedMesh &mesh = *scene.domain.mesh;
    if (!scene.lagrangian_mesh())
      fail(scene,
           "Approximation",
           "the scene imports a mesh (Domain/Mesh), whose cells move with the "
           "matter; allowed is then only 'q4 fem'");
    if (mesh.file.empty() == mesh.generator.empty())
      fail(scene,
           "Domain/Mesh/File",
           "allowed is either a file or a 'Generator', one of them");
  }


  template <int dim>
  bool
  has_node_inside(const Domain<dim> &domain, const Shape<dim> &shape)
  {
    BoundingBox<dim> common;
    return overlap(shape.bounding_box(), box_of(domain), common) &&
           any_of_lattice(common,
                          domain.lower,
                          finest_cell(domain),
                          0.,
                          [&](const Point<dim> &x) {
                            return shape.contains(x);
                          });
  }


  template <int dim>
  void
  check_geometry(const Scene<dim> &scene)
  {
    check_domain(scene);
    if (scene.bodies.empty())
      fail(scene, "Bodies/Names", "the scene needs at least one body");
    for (unsigned int i = 0; i < scene.bodies.size(); ++i)
      {
        check_body(scene, scene.bodies[i]);
        for (unsigned int j = 0; j < i; ++j)
          check_overlap(scene, scene.bodies[j], scene.bodies[i]);
        if (scene.bodies[i].phase >= 32) // they are bits of a number
          fail(scene, "Bodies/Names", "allowed are at most 31 solid bodies");
      }
    check_conditions(scene);
  }


  template void
  check_mesh_source(const Scene<2> &);
  template void
  check_mesh_source(const Scene<3> &);
  template bool
  has_node_inside(const Domain<2> &, const Shape<2> &);
  template bool
  has_node_inside(const Domain<3> &, const Shape<3> &);
  template void
  check_geometry(const Scene<2> &);
  template void
  check_geometry(const Scene<3> &);
} // namespace selkie
