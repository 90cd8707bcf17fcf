#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/terms/effect_table.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    void
    add_limit(ParameterHandler  &prm,
              const std::string &name,
              AuditLimit        &limit,
              const std::string &documentation)
    {
      prm.add_parameter(name,
                        limit,
                        documentation +
                          " Two numbers: where a warning is due, where the run "
                          "is called failed (it goes on); 0 for never. Units: "
                          "none.",
                        Patterns::List(Patterns::Double(0.), 2, 2, ","));
    }


    /// The figures of the points after every step (output/audit) and the
    /// verdict on them. It is there unless Output/Audit is `none`.
    template <int dim>
    class AuditEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames & /*names*/,
              Scene<dim> &scene) override
      {
        AuditLimits &limits = scene.audit.emplace();
        add_limit(prm,
                  "Energy gain",
                  limits.energy_gain,
                  "Energy that no load has put in, of the energy in play.");
        add_limit(prm,
                  "Mass change",
                  limits.mass,
                  "Of all points and those removed, relative to the start.");
        add_limit(prm,
                  "Volume change",
                  limits.volume,
                  "Of scenes with fluids only, relative to the start.");
        add_limit(prm,
                  "Smallest J",
                  limits.smallest_J,
                  "Volume ratio of a point, from below.");
        add_limit(prm,
                  "Unseen energy",
                  limits.unseen_energy,
                  "Kinetic energy of the points that the nodes do not have, "
                  "noise below the mesh, of the energy in play.");
        add_limit(prm,
                  "Checkerboard",
                  limits.checkerboard,
                  "Of the nodes' pressure: rms of the part that alternates "
                  "from node to node in a cell, over that of all of it.");
      }

      void
      check(const Scene<dim> &scene) const override
      {
        const auto check = [&](const char       *name,
                               const AuditLimit &limit,
                               const bool        from_below) {
          const bool ordered =
            limit[0] == 0. || limit[1] == 0. ||
            (from_below ? limit[0] >= limit[1] : limit[0] <= limit[1]);
          if (!ordered)
            fail(scene,
                 std::string("Audit/") + name,
                 "the warning is due before the failure: allowed is a first "
                 "number " +
                   std::string(from_below ? "not below" : "not above") +
                   " the second");
        };
        const AuditLimits &limits = *scene.audit;
        check("Energy gain", limits.energy_gain, false);
        check("Mass change", limits.mass, false);
        check("Volume change", limits.volume, false);
        check("Smallest J", limits.smallest_J, true);
        check("Unseen energy", limits.unseen_energy, false);
        check("Checkerboard", limits.checkerboard, false);
      }
    };
  } // namespace

  EffectRow
  audit_effect()
  {
    EffectRow row = effect_row<AuditEffect>(
      "audit",
      "Audit",
      "Figures of all points after every step, and a verdict on them. There "
      "unless `Output/Audit` is `none`.",
      "one pass over the points and one reduction a step");
    row.comes_with = [](const SceneNames &names) { return names.audit; };
    return row;
  }
} // namespace selkie
