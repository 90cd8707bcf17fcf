#pragma once

#include <selkie/base/types.h>

#include <deal.II/dofs/dof_handler.h>

#include <functional>
#include <map>
#include <string>

namespace selkie
{
  /// The name of a component of a vector field, e.g. "velocity x".
  inline std::string
  component_name(const std::string &field, const unsigned int d)
  {
    return field + ' ' + "xyz"[d];
  }

  /// What nodes keep from step to step, by name, while the mesh changes.
  template <int dim>
  struct CarriedFields
  {
    dealii::DoFHandler<dim>       dofs; ///< FE_Q(1) on the mesh, per layer
    std::map<std::string, Vector> values;
    unsigned int                  n_layers = 1; ///< nodes at each vertex

    /// Copies fields on the nodes of a mesh that @p from numbers.
    void
    take(const dealii::Triangulation<dim>            &mesh,
         const dealii::DoFHandler<dim>               &from,
         const std::map<std::string, const Vector *> &fields);

    /// Numbers the nodes of the mesh as it is and makes room for the values.
    /// Collective.
    void
    reinit();

    void
    update_ghosts();

    /// Lets @p change repartition the mesh; the values go with its cells.
    /// Collective.
    void
    carry_along(const std::function<void()> &change);

    /// Lets @p rebuild make the mesh that the flags of its cells ask for anew.
    /// At a new node values are interpolated; NaN where one of the nodes around
    /// has none. Collective.
    void
    carry_over(const std::function<void()> &rebuild);

    /// Makes a field one that deal.II can carry, and back. Where it has no
    /// value (NaN) a number stands that no field has, and that is still one
    /// after interpolation: cells compare what they say of a node that they
    /// share, and NaN is never equal.
    static void
    make_portable(Vector &field);
    static void
    unmake_portable(Vector &field);

    /// Makes the fields those of finite elements: hanging nodes get what their
    /// masters have there, nodes without a value (NaN) zero. Collective.
    void
    make_continuous();

    /// The values, for those functions of deal.II that take lists.
    std::vector<Vector *>
    pointers();
    std::vector<const Vector *>
    const_pointers() const;
  };
} // namespace selkie
