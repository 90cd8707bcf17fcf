#pragma once

#include <selkie/scene/effect.h>
#include <selkie/scene/scene.h>
#include <selkie/terms/term.h>

#include <memory>
#include <vector>

namespace selkie
{
  /// The terms of the scene's effects, in the table's order.
  template <int dim>
  std::vector<std::shared_ptr<const Term<dim>>>
  terms_of(const Scene<dim> &scene);

  // One row an effect; each is defined in the source of its name.
  EffectRow
  inertia_effect();
  EffectRow
  elasticity_effect();
  EffectRow
  mean_dilatation_effect();
  EffectRow
  mixed_pressure_effect();
  EffectRow
  fluid_pressure_effect();
  EffectRow
  pressure_stabilisation_effect();
  EffectRow
  viscosity_effect();
  EffectRow
  gravity_effect();
  EffectRow
  body_force_effect();
  EffectRow
  traction_effect();
  EffectRow
  spring_foundation_effect();
  EffectRow
  wall_contact_effect();
  EffectRow
  rigid_obstacles_effect();
  EffectRow
  prescribed_motion_effect();
  EffectRow
  contact_effect();
  EffectRow
  wall_friction_effect();
  EffectRow
  wall_release_effect();
  EffectRow
  hydrostatic_start_effect();
  EffectRow
  probes_effect();
  EffectRow
  adaptivity_effect();
  EffectRow
  audit_effect();
} // namespace selkie
