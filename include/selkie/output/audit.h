#pragma once

#include <selkie/output/statistics.h>
#include <selkie/particles/particle_set.h>
#include <selkie/particles/volume_ratio.h>

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <limits>

namespace selkie
{
  template <int dim>
  class PointUpdate;

  /**
   * What the material points hold together, in SI units; per metre of depth
   * in 2D. What belongs to an effect that the scene does not list stays zero.
   */
  struct Audit
  {
    double kinetic     = 0; ///< sum of m |v|^2 / 2
    double strain      = 0; ///< solids' stored energy, V_0 W; inf if inverted
    double compression = 0; ///< fluids' energy of compression, V_0 Psi(J)
    double potential   = 0; ///< -sum of m g.x, zero at the origin

    double mass   = 0;
    double volume = 0; ///< sum of J V_0
    double min_J  = std::numeric_limits<double>::infinity();
    double max_J  = -std::numeric_limits<double>::infinity();

    dealii::Tensor<1, 3> momentum;
    dealii::Tensor<1, 3> angular_momentum; ///< about the origin
    dealii::Point<3>     center;           ///< of mass

    /// Kinetic, strain, compression and potential.
    double
    energy() const
    {
      return kinetic + strain + compression + potential;
    }
  };

  /// Sums over all points of all ranks. Collective.
  template <int dim>
  Audit
  audit(const ParticleSet<dim> &particles);

  /// The same over the points as @p update would make them. Collective.
  template <int dim>
  Audit
  audit(const PointUpdate<dim> &update);

  /// Sets the audit's columns of those effects that the scene has.
  template <int dim>
  void
  set_columns(const Audit            &audit,
              const ParticleSet<dim> &particles,
              Statistics             &statistics);
} // namespace selkie
