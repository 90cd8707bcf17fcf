// What a Stepper shows of its nodes, and what they keep from step to step.
#include <selkie/drivers/stepper.h>

#include <map>
#include <string>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  typename Stepper<dim>::NodalFields
  Stepper<dim>::nodal_fields(const double dt) const
  {
    NodalFields   result;
    const Newmark scheme = newmark(dt);
    if (scene.inertia)
      {
        result.mass.reinit(cloud.partitioner());
        for (auto &component : result.velocity)
          component.reinit(cloud.partitioner());
      }
    if (scene.has_pressure())
      result.pressure.reinit(cloud.partitioner());
    for (const unsigned int node : unknowns.owned_nodes())
      {
        const unsigned int u = unknowns.displacement(node);
        for (unsigned int d = 0; scene.inertia && d < dim; ++d)
          result.velocity[d].local_element(node) =
            fields.velocity(scheme, u + d);
        if (scene.inertia)
          result.mass.local_element(node) = fields.mass.local_element(u);
        if (unknowns.first_pressure(node) != invalid_index)
          result.pressure.local_element(node) =
            fields.x.local_element(unknowns.first_pressure(node));
      }
    if (nodes)
      {
        result.displacement = nodes->displacement;
        if (scene.inertia)
          result.velocity = nodes->velocity; // hanging nodes, too
      }
    for (auto &component : result.velocity)
      component.update_ghost_values();
    result.mass.update_ghost_values();
    result.pressure.update_ghost_values();
    return result;
  }

  template <int dim>
  std::map<std::string, const Vector *>
  Stepper<dim>::kept_fields() const
  {
    std::map<std::string, const Vector *> fields;
    for (unsigned int d = 0; nodes && d < dim; ++d)
      {
        fields[component_name("displacement", d)] = &nodes->displacement[d];
        fields[component_name("velocity", d)]     = &nodes->velocity[d];
        fields[component_name("acceleration", d)] = &nodes->acceleration[d];
      }
    for (const auto &[phase, field] : stored_pressures)
      fields[scene.pressure_name(phase)] = &field;
    if (release)
      fields["released walls"] = &release->kept_walls(cloud);
    return fields;
  }

  template <int dim>
  void
  Stepper<dim>::restore(const CarriedFields<dim> &carried,
                        const KeptNumbers        &numbers)
  {
    kept               = numbers;
    const auto restore = [&](const std::string &name, Vector &field) {
      const Vector &values = carried.values.at(name);
      for (unsigned int node = 0; node < cloud.n_owned(); ++node)
        field.local_element(node) = values(cloud.global_index(node));
      field.update_ghost_values();
    };
    for (unsigned int d = 0; nodes && d < dim; ++d)
      {
        restore(component_name("displacement", d), nodes->displacement[d]);
        restore(component_name("velocity", d), nodes->velocity[d]);
        restore(component_name("acceleration", d), nodes->acceleration[d]);
      }
    for (auto &[phase, field] : stored_pressures)
      restore(scene.pressure_name(phase), field);
    if (release)
      {
        Vector walls(cloud.partitioner());
        restore("released walls", walls);
        release->restore(walls);
      }
  }

  template <int dim>
  void
  Stepper<dim>::go_on_from(const CarriedFields<dim> &fields,
                           const KeptNumbers        &numbers,
                           const CostLedger         &costs)
  {
    restore(fields, numbers);
    assembler.go_on_from(costs);
  }

#define INSTANTIATE(dim)                                                      \
  template Stepper<dim>::NodalFields Stepper<dim>::nodal_fields(const double) \
    const;                                                                    \
  template std::map<std::string, const Vector *> Stepper<dim>::kept_fields()  \
    const;                                                                    \
  template void Stepper<dim>::restore(const CarriedFields<dim> &,             \
                                      const KeptNumbers &);                   \
  template void Stepper<dim>::go_on_from(const CarriedFields<dim> &,          \
                                         const KeptNumbers &,                 \
                                         const CostLedger &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
