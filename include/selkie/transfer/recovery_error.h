#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/assembly/system.h>
#include <selkie/shape/support_table.h>

namespace selkie
{
  /// An error in space and the size of the field, root mean squares.
  struct RecoveryError
  {
    double error = 0, norm = 0;
  };

  /**
   * What the mesh cannot resolve of the nodes' velocity (of their increment
   * without inertia), after Zienkiewicz & Zhu (1987): gradients at the material
   * points against gradients that are averaged at the nodes and interpolated
   * back,
   *   h |grad v - sum_a N_a G_a|,  G_a = sum_p V N_a grad v / sum_p V N_a,
   * times the cell size, as the field is one power of h better than its
   * gradient. Collective.
   */
  template <int dim>
  RecoveryError
  recovery_error(const SupportTable<dim> &table,
                 const System<dim>       &system,
                 const Newmark           &newmark,
                 const StepFields        &fields);
} // namespace selkie
