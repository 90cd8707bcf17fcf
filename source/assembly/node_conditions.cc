#include <selkie/assembly/node_conditions.h>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  NodeConditions<dim>::NodeConditions(const Scene<dim>     &scene,
                                      const NodeCloud<dim> &cloud)
    : scene(scene)
    , cloud(cloud)
    , of_wall{}
    , mask(cloud.size(), 0)
    , of_sets(cloud.size(), 0)
    , on_walls(cloud.size(), 0)
    , motion_of(cloud.size(), 0)
  {
    const double tolerance = 1e-8 * cloud.smallest_spacing();
    for (unsigned int w = 0; w < 2 * dim; ++w)
      {
        const Wall<dim>   &wall = scene.domain.walls[w];
        const unsigned int d    = w / 2;
        for (unsigned int i = 0; i < dim; ++i)
          of_wall[w] |= wall.components[i] ? 1u << i : 0u;
        const double plane =
          (w % 2 == 0) ? scene.domain.lower[d] : scene.domain.upper[d];
        for (unsigned int node = 0; node < cloud.size(); ++node)
          if (std::abs(cloud.position(node)[d] - plane) < tolerance)
            on_walls[node] |= 1u << w;
      }
    place_sets(0.);
  }

  template <int dim>
  void
  NodeConditions<dim>::place_sets(const double t)
  {
    motions.clear();
    std::fill(of_sets.begin(), of_sets.end(), 0);
    std::fill(motion_of.begin(), motion_of.end(), 0);
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (scene.domain.walls[w].condition == NodeCondition::prescribed)
        {
          const auto velocity = scene.domain.walls[w].velocity;
          motions.push_back([velocity](const Point<dim> &x, const double time) {
            return velocity->value(x, time, x);
          });
          for (unsigned int node = 0; node < cloud.size(); ++node)
            if ((on_walls[node] >> w) & 1u)
              motion_of[node] = motions.size();
        }
    for (const auto &set : scene.node_sets)
      place(set, t);
    for (unsigned int node = 0; node < cloud.size(); ++node)
      release(node, 0);
  }

  template <int dim>
  void
  NodeConditions<dim>::place(const NodeSet<dim> &set, const double t)
  {
    if (set.condition == NodeCondition::prescribed)
      motions.push_back(
        [velocity = set.velocity](const Point<dim> &x, const double time) {
          return velocity->value(x, time, x);
        });
    if (set.condition == NodeCondition::moving)
      motions.push_back([path = set.path](const Point<dim> &x,
                                          const double      time) {
        constexpr double h = 1e-6; // s; central difference
        return (path->value(x, time + h) - path->value(x, time - h)) / (2. * h);
      });
    const Tensor<1, dim> moved = set.condition == NodeCondition::moving
                                   ? set.path->value(Point<dim>(), t)
                                   : Tensor<1, dim>();
    for (unsigned int node = 0; node < cloud.size(); ++node)
      if (set.shape->contains(cloud.position(node) - moved))
        {
          for (unsigned int d = 0; d < dim; ++d)
            if (set.components[d])
              of_sets[node] |= 1u << d;
          if (set.condition != NodeCondition::fixed)
            motion_of[node] = motions.size();
        }
  }

  template <int dim>
  void
  NodeConditions<dim>::release(const unsigned int node,
                               const unsigned int walls)
  {
    mask[node] = of_sets[node];
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
