#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/scene/scene.h>

#include <vector>

namespace selkie
{
  /**
   * What walls and named node sets prescribe, node by node; by position only,
   * so every rank knows it for its halo too. Built once per mesh.
   */
  template <int dim>
  class NodeConditions
  {
  public:
    NodeConditions(const Scene<dim> &scene, const NodeCloud<dim> &cloud);

    /// Bit i: displacement component i of the node is prescribed.
    unsigned int
    held(const unsigned int node) const
    {
      return mask[node];
    }

    /// Prescribed velocity (m/s) at time t; zero where nothing moves.
    dealii::Tensor<1, dim>
    velocity(const unsigned int node, const double t) const;

    /// Whether some held node may move.
    bool
    any_motion() const;

    /// The walls that the node lies on, as bits in the order x-, x+, y-, …
    unsigned int
    walls(const unsigned int node) const
    {
      return on_walls[node];
    }

  private:
    const NodeCloud<dim>                      &cloud;
    std::vector<unsigned int>                  mask, on_walls;
    std::vector<const VectorExpression<dim> *> motions;
    std::vector<unsigned int> motion_of; ///< index + 1 into motions; 0: none
  };
} // namespace selkie
