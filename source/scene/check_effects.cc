#include <selkie/laws/newtonian_fluid.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    void
    check_viscosity(const Scene<dim> &scene)
    {
      if (!scene.viscosity)
        return;
      if (!scene.has_fluid())
        fail(scene,
             "Effects",
             "'viscosity' needs a fluid, and no body of the scene has a "
             "fluid's law");
      for (const auto &body : scene.bodies)
        {
          const auto *fluid = dynamic_cast<const FluidLaw *>(body.law.get());
          if (fluid != nullptr && fluid->viscosity() > 0)
            return;
        }
      fail(scene,
           "Effects",
           "'viscosity' is listed, and the Viscosity of every fluid is 0; "
           "give one a positive value or remove the effect");
    }


    template <int dim>
    void
    check_gravity(const Scene<dim> &scene)
    {
      if (scene.gravity && scene.gravity->norm() == 0)
        fail(scene,
             "Gravity/Acceleration",
             "the effect 'gravity' is listed with an acceleration of zero; "
             "allowed is any other, or remove the effect");
      if (!scene.has_effect("hydrostatic start"))
        return;
      if (!scene.gravity)
        fail(scene,
             "Effects",
             "'hydrostatic start' needs the effect 'gravity'");
      if (!scene.has_fluid())
        fail(scene,
             "Effects",
             "'hydrostatic start' needs a fluid, and no body of the scene has "
             "a fluid's law");
      for (const auto &body : scene.bodies)
        if (body.hydrostatic_start && body.phase != 0)
          fail(scene,
               "Hydrostatic start/Bodies",
               "the body '" + body.name +
                 "' is not a fluid; allowed are the scene's fluids");
    }


    template <int dim>
    void
    check_mean_dilatation(const Scene<dim> &scene)
    {
      if (scene.mean_dilatation &&
          std::none_of(scene.bodies.begin(),
                       scene.bodies.end(),
                       [](const Body<dim> &body) { return body.phase != 0; }))
        fail(scene,
             "Effects",
             "'mean dilatation' is for solids, and every body of the scene is "
             "a fluid");
    }


    template <int dim>
    void
    check_body_force(const Scene<dim> &scene)
    {
      const bool listed = scene.has_effect("body force");
      if (listed && !scene.body_force)
        fail(scene,
             "Body force/Acceleration",
             "the effect 'body force' is listed without its function");
    }


    template <int dim>
    void
    check_tractions(const Scene<dim> &scene)
    {
      if (scene.has_effect("traction") && scene.tractions.empty())
        fail(scene,
             "Tractions/Names",
             "the effect 'traction' is listed without a load");
      for (const auto &traction : scene.tractions)
        {
          const std::string path = "Tractions/" + traction.name + "/";
          if (!traction.value)
            fail(scene, path + "Value", "the load needs a function");
          for (const auto &other : scene.tractions)
            if (&other != &traction && other.body == traction.body)
              fail(scene,
                   path + "Body",
                   "a body takes one traction; '" + other.name +
                     "' acts on the same body");
          const Body<dim> &body = scene.bodies[traction.body];
          if (body.phase == 0)
            fail(scene,
                 path + "Body",
                 "a traction acts on a solid, and '" + body.name +
                   "' is a fluid");
          const double box = body.shape->bounding_box().volume();
          // Finite elements have faces; points are those next to a plane one.
          if (!scene.lagrangian_mesh() &&
              std::abs(body.shape->volume() - box) > 1e-10 * box)
            fail(scene,
                 path + "Body",
                 "a traction acts on a face of a box, and the shape of '" +
                   body.name + "' is no box");
        }
    }


    /// Walls and node sets that move, and the effect that allows it.
    template <int dim>
    void
    check_motion(const Scene<dim> &scene)
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
        moves = moves || prescribed;
      };
      const bool listed = scene.has_effect("prescribed motion");
      const auto names  = wall_names<dim>();
      for (unsigned int w = 0; w < names.size(); ++w)
        check(scene.domain.walls[w].condition,
              scene.domain.walls[w].velocity != nullptr,
              "Domain/Walls/" + names[w] + " velocity",
              "Domain/Walls/" + names[w]);
      for (const auto &set : scene.node_sets)
        check(set.condition,
              set.velocity != nullptr,
              "Node sets/" + set.name + "/Velocity",
              "Node sets/" + set.name + "/Condition");
      if (moves && !listed)
        fail(scene,
             "Effects",
             "a wall or a node set is 'prescribed'; that needs the effect "
             "'prescribed motion'");
      if (listed && !moves)
        fail(scene,
             "Effects",
             "'prescribed motion' is listed, and no wall or node set is "
             "'prescribed'");
    }


    template <int dim>
    void
    check_probes(const Scene<dim> &scene)
    {
      using Kind = typename Probe<dim>::Kind;
      if (scene.has_effect("probes") && scene.probes.empty())
        fail(scene,
             "Probes/Names",
             "the effect 'probes' is listed without a probe");
      const BoundingBox<dim> domain({scene.domain.lower, scene.domain.upper});
      for (const auto &probe : scene.probes)
        {
          const std::string path = "Probes/" + probe.name + "/";
          if (probe.kind == Kind::region && !probe.shape)
            fail(scene, path + "Shape", "a region probe needs a shape");
          if (probe.kind == Kind::error && !probe.function)
            fail(scene,
                 path + "Function",
                 "an error probe needs the function that is compared with");
          if (probe.kind == Kind::error && !scene.inertia &&
              probe.quantity == Probe<dim>::Quantity::velocity)
            fail(scene,
                 path + "Quantity",
                 "a scene without the effect 'inertia' has no velocity; "
                 "allowed is only 'displacement'");
          if (probe.kind == Kind::node && !scene.lagrangian_mesh())
            fail(scene,
                 path + "Kind",
                 "nodes move with the matter only with 'Approximation' = 'q4 "
                 "fem'; allowed here is 'point' or 'region'");
          if ((probe.kind == Kind::point || probe.kind == Kind::node) &&
              !domain.point_inside(probe.position, 1e-10))
            fail(scene, path + "Position", "the probe lies outside the domain");
        }
    }
  } // namespace


  template <int dim>
  void
  check_effects(const Scene<dim> &scene)
  {
    check_viscosity(scene);
    check_gravity(scene);
    check_mean_dilatation(scene);
    check_body_force(scene);
    check_tractions(scene);
    check_motion(scene);
    check_probes(scene);
  }


  template void
  check_effects(const Scene<2> &);
  template void
  check_effects(const Scene<3> &);
} // namespace selkie
