#pragma once

#include <selkie/base/types.h>
#include <selkie/mesh/node_cloud.h>

#include <deal.II/base/tensor.h>

#include <array>
#include <string>
#include <vector>

namespace selkie
{
  /// Force that the matter exerts on each wall, from the reaction of the
  /// equations held there: N, N/m in 2D. Empty where not known.
  template <int dim>
  struct WallForces
  {
    std::vector<dealii::Tensor<1, dim>> force;  ///< by wall: x-, x+, y-, ...
    std::vector<dealii::Tensor<1, 3>>   moment; ///< about the origin (N m)
  };

  /// What the nodes have, in cloud numbering with ghosts; null where nothing.
  template <int dim>
  struct NodeMotion
  {
    const NodeCloud<dim>          *cloud        = nullptr;
    const std::array<Vector, dim> *displacement = nullptr; ///< Lagrangian (m)
    const std::array<Vector, dim> *velocity     = nullptr; ///< m/s, as well
    const Vector *pressure = nullptr; ///< fluids; NaN at nodes without (Pa)
  };

  /// What an effect writes during a run, besides the statistics: it reads the
  /// run's state and changes nothing.
  template <int dim>
  class Recorder
  {
  public:
    virtual ~Recorder() = default;

    /// For the timer tree.
    virtual std::string
    name() const = 0;

    /// Time between two records (s); 0: every step.
    virtual double
    interval() const = 0;

    /// Adds the state at @p time (s) to its files. Collective.
    virtual void
    record(const double           time,
           const WallForces<dim> &walls,
           const NodeMotion<dim> &nodes) = 0;
  };
} // namespace selkie
