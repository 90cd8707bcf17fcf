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
    std::vector<dealii::Tensor<1, dim>> force; ///< by wall: x-, x+, y-, ...
  };

  /// The nodes of a Lagrangian mesh: cloud numbering.
  template <int dim>
  struct NodeMotion
  {
    const NodeCloud<dim>          *cloud        = nullptr;
    const std::array<Vector, dim> *displacement = nullptr; ///< m
    const std::array<Vector, dim> *velocity     = nullptr; ///< m/s
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
    /// @param nodes of a Lagrangian mesh; empty otherwise
    virtual void
    record(const double           time,
           const WallForces<dim> &walls,
           const NodeMotion<dim> &nodes) = 0;
  };
} // namespace selkie
