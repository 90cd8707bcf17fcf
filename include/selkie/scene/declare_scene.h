#pragma once

#include <selkie/laws/law_table.h>
#include <selkie/scene/scene.h>

#include <deal.II/base/parameter_handler.h>

#include <array>
#include <string>
#include <vector>

namespace selkie
{
  /// What a scene says before its parameters can be declared: the names of
  /// its parts, in the order in which the scene lists them.
  struct SceneNames
  {
    std::vector<std::string>    effects;
    std::vector<std::string>    bodies;
    std::vector<const LawRow *> laws; ///< one per body
    std::vector<std::string>    refinements, node_sets, tractions, probes;
    bool imported_mesh = false; ///< whether Domain/Mesh is there
    bool holding_walls = true;  ///< whether a wall is not free
    bool audit         = true;  ///< whether Output/Audit is not none

    bool
    has_effect(const std::string &name) const;

    bool
    has_fluid() const;

    bool
    has_solid() const;

    /// Whether there is a solid whose law does not decouple shape and volume.
    bool
    has_coupled_solid() const;
  };

  /// Names of the walls in boundary order: left, right, bottom, top (, front,
  /// back); faces of a box have the same names.
  template <int dim>
  std::vector<std::string>
  wall_names();

  /// A list of walls, "Walls", in the current subsection: the default is all.
  template <int dim>
  void
  add_walls(dealii::ParameterHandler  &prm,
            std::array<bool, 2 * dim> &walls,
            const std::string         &documentation);

  /// Declares every parameter that a scene with these names has, tied to the
  /// members of @p scene, which has to outlive @p prm. Bodies' laws and
  /// references between the parts are left to read_scene().
  template <int dim>
  void
  declare_scene(dealii::ParameterHandler &prm,
                const SceneNames         &names,
                Scene<dim>               &scene);

  /// A part of declare_scene(), in a file of its own: LME, transfer, time,
  /// Newton, linear solver.
  template <int dim>
  void
  declare_numerics(dealii::ParameterHandler &prm, Scene<dim> &scene);

  /// Another: the bodies.
  template <int dim>
  void
  declare_bodies(dealii::ParameterHandler &prm,
                 const SceneNames         &names,
                 Scene<dim>               &scene);
} // namespace selkie
