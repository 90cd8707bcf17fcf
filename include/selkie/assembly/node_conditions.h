#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/scene/scene.h>

#include <array>
#include <functional>
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

    /// The walls that the node lies on, as bits in the order x-, x+, y-, …
    unsigned int
    walls(const unsigned int node) const
    {
      return on_walls[node];
    }

    /// Finds the nodes of the sets anew, where `moving` sets are at time t (s).
    void
    place_sets(const double t);

    /// From now on the node's walls in @p walls (bits as in walls()) hold it
    /// no longer; all others do. What node sets hold stays held.
    void
    release(const unsigned int node, const unsigned int walls);

  private:
    /// Velocity (m/s) at a place and time.
    using Motion =
      std::function<dealii::Tensor<1, dim>(const dealii::Point<dim> &,
                                           const double)>;

    void
    place(const NodeSet<dim> &set, const double t);

    const Scene<dim>                 &scene;
    const NodeCloud<dim>             &cloud;
    std::array<unsigned int, 2 * dim> of_wall; ///< components that it holds
    std::vector<unsigned int>         mask, of_sets, on_walls;
    std::vector<Motion>               motions;
    std::vector<unsigned int> motion_of; ///< index + 1 into motions; 0: none
  };
} // namespace selkie
