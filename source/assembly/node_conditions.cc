#include <selkie/assembly/node_conditions.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    template <std::size_t n>
    unsigned int
    as_bits(const std::array<bool, n> &components)
    {
      unsigned int bits = 0;
      for (unsigned int d = 0; d < n; ++d)
        bits |= components[d] ? 1u << d : 0u;
      return bits;
    }
  } // namespace

  template <int dim>
  NodeConditions<dim>::NodeConditions(const Scene<dim>     &scene,
                                      const NodeCloud<dim> &cloud)
    : scene(scene)
    , cloud(cloud)
    , of_wall{}
    , mask(cloud.size(), 0)
    , of_nodes(cloud.size(), 0)
    , on_walls(cloud.size(), 0)
    , motion_of(cloud.size(), 0)
  {
    const double tolerance = 1e-8 * cloud.smallest_spacing();
    for (unsigned int w = 0; w < 2 * dim; ++w)
      {
        const unsigned int d = w / 2;
        const double       plane =
          (w % 2 == 0) ? scene.domain.lower[d] : scene.domain.upper[d];
        for (unsigned int node = 0; node < cloud.size(); ++node)
          if (std::abs(cloud.position(node)[d] - plane) < tolerance)
            on_walls[node] |= 1u << w;
      }
    find(0.);
  }

  template <int dim>
  void
  NodeConditions<dim>::find(const double t)
  {
    motions.clear();
    of_wall.fill(0);
    std::fill(of_nodes.begin(), of_nodes.end(), 0);
    std::fill(motion_of.begin(), motion_of.end(), 0);
    for (const auto &active : scene.effects)
      active.effect->hold(scene, cloud, t, *this);
    for (unsigned int node = 0; node < cloud.size(); ++node)
      release(node, 0);
  }

  template <int dim>
  unsigned int
  NodeConditions<dim>::number_of(const Motion &motion)
  {
    if (!motion)
      return 0;
    motions.push_back(motion);
    return motions.size();
  }

  template <int dim>
  void
  NodeConditions<dim>::hold_wall(const unsigned int wall,
                                 const Components  &components,
                                 const Motion      &motion)
  {
    of_wall[wall]             = as_bits(components);
    const unsigned int number = number_of(motion);
    for (unsigned int node = 0; number != 0 && node < cloud.size(); ++node)
      if ((on_walls[node] >> wall) & 1u)
        motion_of[node] = number;
  }

  template <int dim>
  void
  NodeConditions<dim>::hold_nodes(const std::vector<unsigned int> &nodes,
                                  const Components                &components,
                                  const Motion                    &motion)
  {
    const unsigned int number = number_of(motion);
    for (const unsigned int node : nodes)
      {
        of_nodes[node] |= as_bits(components);
        if (number != 0)
          motion_of[node] = number;
      }
  }

  template <int dim>
  void
  NodeConditions<dim>::release(const unsigned int node,
                               const unsigned int walls)
  {
    mask[node] = of_nodes[node];
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (((on_walls[node] & ~walls) >> w) & 1u)
        mask[node] |= of_wall[w];
  }

  template <int dim>
  Tensor<1, dim>
  NodeConditions<dim>::velocity(const unsigned int node, const double t) const
  {
    return motion_of[node] == 0
             ? Tensor<1, dim>()
             : motions[motion_of[node] - 1](cloud.position(node), t);
  }

  template class NodeConditions<2>;
  template class NodeConditions<3>;
} // namespace selkie
