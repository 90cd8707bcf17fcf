#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/scene/scene.h>

#include <array>
#include <functional>
#include <vector>

namespace selkie
{
  /**
   * Which displacement components of which nodes are prescribed, and to what
   * velocity, node by node; by position only, so every rank knows it for its
   * halo too. The effects of the scene say so (Effect::hold): walls and rigid
   * obstacles. Built once per mesh.
   */
  template <int dim>
  class NodeConditions
  {
  public:
    /// Velocity (m/s) at a place and time; none stands for rest.
    using Motion =
      std::function<dealii::Tensor<1, dim>(const dealii::Point<dim> &,
                                           const double)>;

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

    /// Asks the effects anew what they hold at time t (s).
    void
    find(const double t);

    /// Which displacement components are held.
    using Components = std::array<bool, dim>;

    /// Holds components of all nodes on a wall.
    void
    hold_wall(const unsigned int wall,
              const Components  &components,
              const Motion      &motion = Motion());

    /// Holds components of nodes wherever they are.
    void
    hold_nodes(const std::vector<unsigned int> &nodes,
               const Components                &components,
               const Motion                    &motion = Motion());

    /// From now on the node's walls in @p walls (bits as in walls()) hold it
    /// no longer; all others do. What obstacles hold stays held.
    void
    release(const unsigned int node, const unsigned int walls);

  private:
    unsigned int
    number_of(const Motion &motion);

    const Scene<dim>                 &scene;
    const NodeCloud<dim>             &cloud;
    std::array<unsigned int, 2 * dim> of_wall; ///< components that it holds
    std::vector<unsigned int>         mask, of_nodes, on_walls;
    std::vector<Motion>               motions;
    std::vector<unsigned int> motion_of; ///< index + 1 into motions; 0: none
  };
} // namespace selkie
