#include <selkie/assembly/node_conditions.h>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  NodeConditions<dim>::NodeConditions(const Scene<dim>     &scene,
                                      const NodeCloud<dim> &cloud)
    : cloud(cloud)
    , mask(cloud.size(), 0)
    , on_walls(cloud.size(), 0)
    , motion_of(cloud.size(), 0)
  {
    const auto moves_with = [this](const unsigned int           node,
                                   const VectorExpression<dim> *velocity) {
      if (motions.empty() || motions.back() != velocity)
        motions.push_back(velocity);
      motion_of[node] = motions.size();
    };
    const double tolerance = 1e-8 * cloud.smallest_spacing();

    for (unsigned int w = 0; w < 2 * dim; ++w)
      {
        const Wall<dim>   &wall = scene.domain.walls[w];
        const unsigned int d    = w / 2;
        const double       plane =
          (w % 2 == 0) ? scene.domain.lower[d] : scene.domain.upper[d];
        for (unsigned int node = 0; node < cloud.size(); ++node)
          if (std::abs(cloud.position(node)[d] - plane) < tolerance)
            {
              on_walls[node] |= 1u << w;
              for (unsigned int i = 0; i < dim; ++i)
                if (wall.components[i])
                  mask[node] |= 1u << i;
              if (wall.condition == NodeCondition::prescribed)
                moves_with(node, wall.velocity.get());
            }
      }

    for (const auto &set : scene.node_sets)
      for (unsigned int node = 0; node < cloud.size(); ++node)
        if (set.shape->contains(cloud.position(node)))
          {
            for (unsigned int d = 0; d < dim; ++d)
              if (set.components[d])
                mask[node] |= 1u << d;
            if (set.condition == NodeCondition::prescribed)
              moves_with(node, set.velocity.get());
          }
  }

  template <int dim>
  Tensor<1, dim>
  NodeConditions<dim>::velocity(const unsigned int node, const double t) const
  {
    if (motion_of[node] == 0)
      return Tensor<1, dim>();
    const Point<dim> &x = cloud.position(node);
    return motions[motion_of[node] - 1]->value(x, t, x);
  }

  template <int dim>
  bool
  NodeConditions<dim>::any_motion() const
  {
    return !motions.empty();
  }

  template class NodeConditions<2>;
  template class NodeConditions<3>;
} // namespace selkie
