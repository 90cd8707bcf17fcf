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
         {"front", Kind::front},
         {"extent", Kind::extent},
         {"error", Kind::error}},
        "`point` is the mean of the material points that start within "
        "Radius of Position, `node` the node of a finite element mesh "
        "(`q4 fem`) that starts nearest to Position, `region` of those that start in Shape, "
        "`wall force` the reaction of Wall, `front` the largest "
        "coordinate along Axis that Body reaches, `extent` the "
        "smallest and largest coordinates, volume and centroid of "
        "Body, `error` how far Body's Quantity is from Function: the norm "
        "over the body's points, weighted with their reference volumes, and "
        "the largest. Units: none.");
      prm.add_parameter("Position",
                        probe.position,
                        "For `point` and `node`. Units: m.");
      prm.add_parameter("Radius",
                        probe.radius,
                        "For `point`; 0 means one cell. Units: m.",
                        Patterns::Double(0.));
      add_shape(prm,
                "Shape",
                probe.shape,
                "For `region`; written as a body's shape. Units: m.");
      add_index(prm,
                "Wall",
                probe.wall,
                wall_names<dim>(),
                "wall",
                "For `wall force`: left, right, bottom, top, front, back. "
                "Units: none.");
      add_index(prm,
                "Body",
                probe.body,
                names.bodies,
                "body",
                "For `front`, `extent` and `error`; the default is the first "
                "one. Units: none.");
      add_choice<unsigned int>(
        prm,
        "Axis",
        probe.axis,
        dim == 2 ? std::vector<std::pair<std::string, unsigned int>>{{"x", 0},
                                                                     {"y", 1}}
                 : std::vector<std::pair<std::string, unsigned int>>{{"x", 0},
                                                                     {"y", 1},
                                                                     {"z", 2}},
        "For `front`. Units: none.");
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
