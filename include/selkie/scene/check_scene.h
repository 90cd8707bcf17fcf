#pragma once

#include <selkie/scene/scene.h>

#include <array>
#include <string>
#include <vector>

namespace selkie
{
  /**
   * All rules that need more than one parameter, before anything is allocated
   * or written. read_scene() calls it.
   * @throw SceneError naming file, parameter, value and what is allowed.
   */
  template <int dim>
  void
  check_scene(const Scene<dim> &scene);

  /// Whether a node of the finest cells lies in the shape.
  template <int dim>
  bool
  has_node_inside(const Domain<dim> &domain, const Shape<dim> &shape);

  /// The part of check_scene() that looks at places: domain, bodies,
  /// refinements.
  template <int dim>
  void
  check_geometry(const Scene<dim> &scene);

  /// The parameters of Domain/Mesh: before the mesh is made.
  /// @throw SceneError as above.
  template <int dim>
  void
  check_mesh_source(const Scene<dim> &scene);

  /// Ends with a SceneError about one parameter of a scene.
  template <int dim>
  [[noreturn]] void
  fail(const Scene<dim>  &scene,
       const std::string &path,
       const std::string &why);

  /// Ends with a SceneError about an effect that is listed and does nothing,
  /// and says what it would have cost (EffectRow::cost).
  /// @param nothing what makes it do nothing, "an acceleration of zero"
  template <int dim>
  [[noreturn]] void
  fail_without_need(const Scene<dim>  &scene,
                    const std::string &effect,
                    const std::string &path,
                    const std::string &nothing);

  /// That a list of walls ("all" if the parameter is empty) names only walls
  /// of the allowed conditions, and at least one.
  /// @throw SceneError as above.
  template <int dim>
  void
  check_walls(const Scene<dim>                 &scene,
              const std::string                &path,
              const std::array<bool, 2 * dim>  &walls,
              const std::vector<NodeCondition> &allowed);

  /// Smallest extent of the cells before refinement, m.
  template <int dim>
  double
  cell_size(const Domain<dim> &domain);
} // namespace selkie
