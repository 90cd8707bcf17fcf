#include <selkie/transfer/nodal_state.h>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  NodalState<dim>::NodalState(const NodeCloud<dim> &cloud,
                              const Q4Support<dim> &q4)
    : q4(q4)
  {
    for (auto *field : {&displacement, &velocity, &acceleration})
      for (Vector &component : *field)
        component.reinit(cloud.partitioner());
    complete();
  }

  template <int dim>
  void
  NodalState<dim>::start(const Scene<dim>        &scene,
                         const NodeCloud<dim>    &cloud,
                         const SupportTable<dim> &table)
  {
    std::array<Vector, dim> sum;
    Vector                  count(cloud.partitioner());
    for (Vector &component : sum)
      component.reinit(cloud.partitioner());
    for (const auto &patch : table.patches)
      {
        const auto &body = scene.bodies[table.points[patch.first_point].body];
        for (unsigned int k = 0; k < patch.n_nodes; ++k)
          {
            const unsigned int node = table.nodes[patch.first_node + k];
            count.local_element(node) += 1.;
            if (!body.initial_velocity)
              continue;
            const Point<dim>    &X = cloud.position(node);
            const Tensor<1, dim> v = body.initial_velocity->value(X, 0., X);
            for (unsigned int d = 0; d < dim; ++d)
              sum[d].local_element(node) += v[d];
          }
      }
    count.compress(VectorOperation::add);
    for (unsigned int d = 0; d < dim; ++d)
      {
        sum[d].compress(VectorOperation::add);
        for (unsigned int node = 0; node < cloud.n_owned(); ++node)
          if (count.local_element(node) > 0.)
            velocity[d].local_element(node) =
              sum[d].local_element(node) / count.local_element(node);
      }
    complete();
  }

  template <int dim>
  void
  NodalState<dim>::recall(const System<dim> &system, StepFields &fields) const
  {
    for (const unsigned int node : system.owned_nodes())
      for (unsigned int d = 0; d < dim; ++d)
        {
          const unsigned int u        = system.displacement(node) + d;
          fields.v_n.local_element(u) = velocity[d].local_element(node);
          fields.a_n.local_element(u) = acceleration[d].local_element(node);
        }
  }

  template <int dim>
  void
  NodalState<dim>::set_acceleration(const System<dim> &system, const Vector &a)
  {
    for (const unsigned int node : system.owned_nodes())
      for (unsigned int d = 0; d < dim; ++d)
        acceleration[d].local_element(node) =
          a.local_element(system.displacement(node) + d);
    complete();
  }

  template <int dim>
  void
  NodalState<dim>::keep(const System<dim> &system,
                        const Newmark     &newmark,
                        const StepFields  &fields)
  {
    for (const unsigned int node : system.owned_nodes())
      for (unsigned int d = 0; d < dim; ++d)
        {
          const unsigned int u = system.displacement(node) + d;
          displacement[d].local_element(node) += fields.x.local_element(u);
          if (fields.v_n.size() == 0)
            continue;
          velocity[d].local_element(node) = fields.velocity(newmark, u);
          acceleration[d].local_element(node) =
            newmark.acceleration(fields.x.local_element(u),
                                 fields.v_n.local_element(u),
                                 fields.a_n.local_element(u));
        }
    complete();
  }

  template <int dim>
  void
  NodalState<dim>::complete()
  {
    for (auto *field : {&displacement, &velocity, &acceleration})
      for (Vector &component : *field)
        q4.interpolate_hanging(component);
  }

  template struct NodalState<2>;
  template struct NodalState<3>;
} // namespace selkie
