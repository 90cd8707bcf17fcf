#include <selkie/mesh/background_mesh.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/terms/effect_table.h>

#include <array>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// A background mesh that follows the matter (folder adapt/). It changes
    /// between steps, so there is no term.
    template <int dim>
    class AdaptivityEffect : public Effect<dim>
    {
    public:
      void
      declare(ParameterHandler &prm,
              const SceneNames &names,
              Scene<dim>       &scene) override
      {
        Adaptivity &wishes = scene.adaptivity.emplace();
        declare_levels(prm, wishes);
        declare_criteria(prm, names, wishes);
        add_choice(prm,
                   "Points",
                   wishes.points,
                   {{"split and merge", PointAdaptation::split_and_merge},
                    {"split", PointAdaptation::split},
                    {"keep", PointAdaptation::keep}},
                   "What is done with points that are too large for their cell "
                   "or too small. With 'q4 fem' they are the Gauss points of "
                   "their element. Units: none.");
      }

      void
      check(const Scene<dim> &scene) const override
      {
        const Adaptivity &wishes = *scene.adaptivity;
        if (scene.approximation == Approximation::q4_mpm)
          fail(scene,
               "Effects",
               "'adaptivity' needs 'Approximation' = 'lme mpm' or 'q4 fem': "
               "points under bilinear functions do not follow a change of the "
               "mesh");
        if (scene.domain.mesh)
          fail(scene,
               "Effects",
               "'adaptivity' needs a box of cells (Domain/Cells): cells of an "
               "imported mesh would not keep their bodies' volume when they "
               "are halved");
        if (scene.release)
          fail(scene,
               "Effects",
               "'adaptivity' and 'wall release' do not go together: the nodes "
               "of a new mesh do not know which wall has let them go");
        if (wishes.coarser > base_level(scene.domain))
          fail(scene,
               "Adaptivity/Coarser levels",
               "the cells (Domain/Cells) cannot be joined so often; allowed is "
               "at most " +
                 std::to_string(base_level(scene.domain)) +
                 ", how often all their numbers can be halved");
        check_criteria(scene, wishes);
      }

    private:
      static void
      declare_levels(ParameterHandler &prm, Adaptivity &wishes)
      {
        prm.add_parameter("Steps",
                          wishes.steps,
                          "The mesh is adapted after so many steps, or before, "
                          "when a point might leave the buffer in the next. "
                          "Units: none.",
                          Patterns::Integer(1));
        prm.add_parameter("Finer levels",
                          wishes.finer,
                          "How often the cells (Domain/Cells) are halved where "
                          "a criterion holds. Units: none.",
                          Patterns::Integer(0, 8));
        prm.add_parameter("Coarser levels",
                          wishes.coarser,
                          "How often they are joined where none does, and "
                          "where nothing is. Units: none.",
                          Patterns::Integer(0, 8));
        prm.add_parameter("Buffer",
                          wishes.buffer,
                          "Width of the zone around a cell that meets a "
                          "criterion that is as fine; in the finest cells. "
                          "Units: none.",
                          Patterns::Integer(1));
        prm.add_parameter("Most cells",
                          wishes.most_cells,
                          "A mesh of more cells is not refined further. "
                          "Units: none.");
      }

      static void
      declare_criteria(ParameterHandler &prm,
                       const SceneNames &names,
                       Adaptivity       &wishes)
      {
        prm.add_parameter("Surface",
                          wishes.surface,
                          "Whether cells at the edge of the matter, away from "
                          "walls, are the finest; an empty cell that cells "
                          "with points enclose is no edge. Units: none.");
        prm.add_parameter("Interface",
                          wishes.interface,
                          "Whether cells where bodies meet are. Units: none.");
        prm.declare_entry("Bodies",
                          "",
                          Patterns::Anything(),
                          "Bodies whose cells all are, separated by commas. "
                          "Units: none.");
        prm.add_action(
          "Bodies", [&wishes, bodies = names.bodies](const std::string &text) {
            wishes.bodies.clear();
            for (const auto &item : split_list(text))
              wishes.bodies.push_back(index_of(item, bodies, "body"));
          });
        const auto add_limit = [&prm](const std::string &name,
                                      double            &limit,
                                      const std::string &documentation) {
          prm.add_parameter(name,
                            limit,
                            documentation +
                              " Cells above it are the finest, and stay so "
                              "down to half of it. 0: no criterion. Units: "
                              "none.",
                            Patterns::Double(0.));
        };
        add_limit("Strain",
                  wishes.strain,
                  "Norm of Green's strain of a solid's point.");
        prm.add_parameter(
          "Strain variation",
          wishes.strain_variation,
          "Norm of the difference between a point's strain and the mean of its "
          "cell, of the largest strain. A cell above it is halved, down to "
          "'Finer levels', as often as brings it below if its strain is smooth; "
          "cells are joined where it would stay below. 0: no criterion. Units: "
          "none.",
          Patterns::Double(0.));
        prm.add_parameter(
          "Strain error",
          wishes.strain_error,
          "Norm, over a cell, of the difference between its strain and the one "
          "recovered from the means of the cells around its corners, of the "
          "norm of all strain. A cell above it is halved, down to 'Finer "
          "levels', as often as brings it below if its strain is smooth; cells "
          "are joined where it would stay below. While those to be halved hold "
          "less than a fifth of the squared error, and fewer than half of the "
          "cells could be joined, nothing changes. 0: no criterion. Units: none.",
          Patterns::Double(0.));
        add_limit("Velocity difference",
                  wishes.velocity,
                  "Between corners of a cell, of the largest speed.");
        add_limit("Pressure difference",
                  wishes.pressure,
                  "Between corners of a cell, of the largest pressure.");
        add_limit("Velocity error",
                  wishes.error,
                  "What a cell twice as wide would miss of the velocity in its "
                  "centre, of the largest speed.");
      }

      static void
      check_criteria(const Scene<dim> &scene, const Adaptivity &wishes)
      {
        const bool any = wishes.surface || wishes.interface ||
                         !wishes.bodies.empty() || wishes.strain > 0. ||
                         wishes.strain_variation > 0. ||
                         wishes.strain_error > 0. || wishes.velocity > 0. ||
                         wishes.pressure > 0. || wishes.error > 0.;
        if (!any)
          fail(
            scene,
            "Effects",
            "'adaptivity' needs a criterion (section Adaptivity): Surface, "
            "Interface, Bodies, Strain, Strain variation, Strain "
            "error, Velocity difference, Pressure difference or Velocity error");
        const auto need = [&scene](const double       limit,
                                   const bool         there,
                                   const std::string &name,
                                   const std::string &what) {
          if (limit > 0. && !there)
            fail(scene, "Adaptivity/" + name, "the scene has no " + what);
        };
        const bool moves = scene.inertia.has_value();
        need(wishes.strain, scene.has_solid(), "Strain", "solid");
        need(wishes.strain_variation,
             scene.has_solid(),
             "Strain variation",
             "solid");
        need(wishes.strain_error, scene.has_solid(), "Strain error", "solid");
        need(wishes.velocity, moves, "Velocity difference", "inertia");
        need(wishes.pressure,
             moves && scene.has_pressure(),
             "Pressure difference",
             "pressure, or no inertia");
        need(wishes.error, moves, "Velocity error", "inertia");
      }
    };
  } // namespace

  EffectRow
  adaptivity_effect()
  {
    return effect_row<AdaptivityEffect>(
      "adaptivity",
      "Adaptivity",
      "The background mesh follows the matter: fine where criteria hold, "
      "coarse elsewhere, and the points follow the mesh.",
      "a new mesh and all that hangs on it every so many steps; nothing in any "
      "loop");
  }
} // namespace selkie
