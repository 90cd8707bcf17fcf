#include <selkie/terms/term_table.h>

#include <algorithm>

namespace selkie
{
  template <int dim>
  std::vector<std::unique_ptr<const Term<dim>>>
  make_terms(const Scene<dim> &scene)
  {
    std::vector<std::unique_ptr<const Term<dim>>> terms;
    const bool                                    has_solid =
      std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const auto &b) {
        return b.law->phase() == Phase::solid;
      });

    if (scene.inertia)
      terms.push_back(make_inertia<dim>(*scene.inertia));
    if (has_solid)
      terms.push_back(scene.mean_dilatation ? make_mean_dilatation<dim>()
                                            : make_elasticity<dim>());
    if (scene.fluid_pressure)
      terms.push_back(make_fluid_pressure<dim>());
    if (scene.fluid_pressure && scene.fluid_pressure->ppp_alpha > 0.)
      terms.push_back(
        make_pressure_stabilisation<dim>(scene.fluid_pressure->ppp_alpha));
    if (scene.viscosity)
      terms.push_back(make_viscosity<dim>());
    if (scene.gravity)
      terms.push_back(make_gravity<dim>(*scene.gravity));
    if (scene.body_force)
      terms.push_back(make_body_force<dim>(scene.body_force));
    if (!scene.tractions.empty())
      terms.push_back(make_traction<dim>(scene.tractions));
    return terms;
  }

  template std::vector<std::unique_ptr<const Term<2>>>
  make_terms(const Scene<2> &);
  template std::vector<std::unique_ptr<const Term<3>>>
  make_terms(const Scene<3> &);
} // namespace selkie
