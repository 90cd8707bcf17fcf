#include <selkie/output/probes.h>
#include <selkie/particles/fields.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/terms/effect_table.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    void
    declare_probe(ParameterHandler  &prm,
                  const SceneNames  &names,
                  const std::string &name,
                  Probe<dim>        &probe)
    {
      using Kind     = typename Probe<dim>::Kind;
      using Quantity = typename Probe<dim>::Quantity;
      probe.name     = name;
      prm.enter_subsection(name);
      add_choice(
        prm,
        "Kind",
        probe.kind,
        {{"point", Kind::point},
         {"node", Kind::node},
         {"region", Kind::region},
         {"wall force", Kind::wall_force},
         {"wall pressure", Kind::wall_pressure},
         {"height", Kind::height},
         {"body force", Kind::body_force},
         {"front", Kind::front},
         {"extent", Kind::extent},
         {"error", Kind::error}},
        "`point` is the mean (displacement, position, velocity, a fluid's "
        "pressure) of the material points that start within "
        "Radius of Position, `node` the node of a finite element mesh "
        "(`q4 fem`) that starts nearest to Position, `region` of those that start in Shape, "
        "`wall force` the force on Wall and its moment about Position, `wall "
        "pressure` a gauge: the mean of the fluid's pressure over the part of "
        "Wall inside the box around Shape (with `q4 fem`, of what was there at "
        "the start), and how much of it is wet, `height` "
        "how far Body reaches along Axis within Radius of the line through "
        "Position, `body force` the force of all its surroundings on Body, "
        "from the acceleration of its points less gravity, and its moment "
        "about Position, `front` the largest "
        "coordinate along Axis that Body reaches, `extent` the "
        "smallest and largest coordinates, volume and centroid of "
        "Body, `error` how far Body's Quantity is from Function: the norm "
        "over the body's points, weighted with their reference volumes, and "
        "the largest. Units: none.");
      prm.add_parameter("Position",
                        probe.position,
                        "For `point`, `node`, `height` and moments. Units: "
                        "m.");
      prm.add_parameter("Radius",
                        probe.radius,
                        "For `point` and `height`; 0 means one cell. Units: m.",
                        Patterns::Double(0.));
      add_shape(prm,
                "Shape",
                probe.shape,
                "For `region` and `wall pressure`; written as a body's shape. "
                "Units: m.");
      add_index(prm,
                "Wall",
                probe.wall,
                wall_names<dim>(),
                "wall",
                "For `wall force` and `wall pressure`: left, right, bottom, "
                "top, front, back. Units: none.");
      add_index(
        prm,
        "Body",
        probe.body,
        names.bodies,
        "body",
        "For `front`, `extent`, `height`, `body force` and `error`; the "
        "default is the first one. Units: none.");
      add_choice<unsigned int>(
        prm,
        "Axis",
        probe.axis,
        dim == 2 ? std::vector<std::pair<std::string, unsigned int>>{{"x", 0},
                                                                     {"y", 1}}
                 : std::vector<std::pair<std::string, unsigned int>>{{"x", 0},
                                                                     {"y", 1},
                                                                     {"z", 2}},
        "For `front` and `height`. Units: none.");
      add_choice(prm,
                 "Quantity",
                 probe.quantity,
                 {{"displacement", Quantity::displacement},
                  {"velocity", Quantity::velocity}},
                 "For `error`. Units: none.");
      add_function(prm,
                   "Function",
                   probe.function,
                   "For `error`, what Quantity should be: one function of X, "
                   "Y, Z, x, y, z, t per component, separated by semicolons. "
                   "Units: m or m/s.");
      prm.leave_subsection();
    }


    template <int dim>
    void
    check_gauge(const Scene<dim> &scene, const Probe<dim> &probe)
    {
      const std::string path = "Probes/" + probe.name + "/";
      if (!scene.has_fluid())
        fail(scene, path + "Kind", "a gauge needs a fluid");
      if (scene.domain.mesh)
        fail(scene,
             path + "Kind",
             "an imported mesh has no walls; allowed is 'wall force'");
      const unsigned int d   = probe.wall / 2;
      const auto         box = probe.shape->bounding_box();
      const double       plane =
        probe.wall % 2 == 0 ? scene.domain.lower[d] : scene.domain.upper[d];
      const double h = cell_size(scene.domain);
      if (box.lower_bound(d) > plane + 1e-9 * h ||
          box.upper_bound(d) < plane - 1e-9 * h)
        fail(scene,
             path + "Shape",
             "the box around the shape does not reach the wall '" +
               wall_names<dim>()[probe.wall] + "'");
    }


    /// Whether any material point starts in the shape. Collective.
    template <int dim>
    bool
    has_points(const ParticleSet<dim> &particles, const Shape<dim> &shape)
    {
      const auto    &points = particles.handler();
      const unsigned mine =
        std::any_of(points.begin(), points.end(), [&](const auto &point) {
          return shape.contains(
            Point<dim>(particles.columns.X(point.get_properties())));
        });
      return Utilities::MPI::max(mine, particles.communicator()) > 0;
    }


    /// Curves over time: see class Probes.
    template <int dim>
    class ProbesEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &names,
              Scene<dim>       &scene) override
      {
        prm.declare_entry(
          "Names",
          "",
          Patterns::Anything(),
          "Names of the curves, separated by commas; each is a "
          "subsection and a file probes/NAME.csv. Units: none.");
        prm.add_parameter("Interval",
                          interval,
                          "Time between two rows; 0 for every step. Units: s.",
                          Patterns::Double(0.));
        scene.probes.resize(names.probes.size());
        for (unsigned int i = 0; i < names.probes.size(); ++i)
          declare_probe(prm, names, names.probes[i], scene.probes[i]);
      }

      void
      check(const Scene<dim> &scene) const override
      {
        using Kind = typename Probe<dim>::Kind;
        if (scene.probes.empty())
          fail(scene,
               "Probes/Names",
               "the effect 'probes' is listed without a probe");
        const BoundingBox<dim> domain({scene.domain.lower, scene.domain.upper});
        for (const auto &probe : scene.probes)
          {
            const std::string path = "Probes/" + probe.name + "/";
            if ((probe.kind == Kind::region ||
                 probe.kind == Kind::wall_pressure) &&
                !probe.shape)
              fail(scene, path + "Shape", "such a probe needs a shape");
            if (probe.kind == Kind::wall_pressure)
              check_gauge(scene, probe);
            if (probe.kind == Kind::body_force && !scene.inertia)
              fail(scene,
                   path + "Kind",
                   "the force on a body follows from its acceleration, and a "
                   "scene without the effect 'inertia' has none; allowed is "
                   "'wall force'");
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
              fail(scene,
                   path + "Position",
                   "the probe lies outside the domain");
          }
      }

      void
      add_columns(const Scene<dim> &scene,
                  ParticleFields   &fields) const override
      {
        using Kind        = typename Probe<dim>::Kind;
        const auto starts = [](const Probe<dim> &probe) {
          return probe.kind == Kind::point || probe.kind == Kind::region ||
                 probe.kind == Kind::error;
        };
        if (std::any_of(scene.probes.begin(), scene.probes.end(), starts))
          fields.add<Tensor<1, dim>>("reference position", "m", true);
      }

      void
      start(ParticleSet<dim> &particles) const override
      {
        for (const auto &probe : particles.scene.probes)
          if (probe.kind == Probe<dim>::Kind::region &&
              !has_points(particles, *probe.shape))
            fail(particles.scene,
                 "Probes/" + probe.name + "/Shape",
                 "no material point starts in the region; allowed is one that "
                 "holds points of a body");
      }

      std::shared_ptr<Recorder<dim>>
      recorder(const ParticleSet<dim> &particles) const override
      {
        return std::make_shared<Probes<dim>>(particles.scene,
                                             particles,
                                             particles.scene.output.directory,
                                             interval);
      }

    private:
      double interval = 0.; ///< s; 0: every step
    };
  } // namespace

  EffectRow
  probes_effect()
  {
    return effect_row<ProbesEffect>("probes",
                                    "Probes",
                                    "Curves over time, one CSV file each.",
                                    "a pass over the points for every row");
  }
} // namespace selkie
