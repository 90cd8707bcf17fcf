#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/scene/scene.h>
#include <selkie/time/newmark.h>

#include <array>

namespace selkie
{
  /// Norms of the displacement and of the pressure part of a residual, free
  /// unknowns only. Collective.
  template <int dim>
  std::array<double, 2>
  residual_norms(const System<dim> &system, const Vector &residual);

  /**
   * The sizes of forces, volumes and pressures in play in a step: what Newton's
   * tolerance is relative to (formulation.md, section 5).
   */
  struct ResidualScales
  {
    double u = 0; ///< N (N/m in 2D)
    double p = 0; ///< m^dim; 0 without pressures

    /// Pressure unknowns are counted in it (Pa): the tangent's blocks become
    /// alike in size.
    double pressure_unit = 1;

    /// Of one step; @p acceleration is the terms' own measure (m/s^2).
    /// Collective.
    template <int dim>
    static ResidualScales
    of_step(const Scene<dim>  &scene,
            const System<dim> &system,
            const StepFields  &fields,
            const Newmark     &newmark,
            const double       acceleration);

    /// Size of a residual in units of its tolerance. R_p counts volume: it is
    /// asked for three more digits, since the pressure is K times the volume's
    /// relative error.
    double
    error(const std::array<double, 2> &norms, const double tolerance) const;
  };
} // namespace selkie
