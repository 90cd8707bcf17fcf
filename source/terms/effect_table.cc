#include <selkie/terms/effect_table.h>

namespace selkie
{
  const std::vector<EffectRow> &
  effect_table()
  {
    static const std::vector<EffectRow> table = {
      inertia_effect(),
      elasticity_effect(),
      mean_dilatation_effect(),
      mixed_pressure_effect(),
      fluid_pressure_effect(),
      pressure_stabilisation_effect(),
      viscosity_effect(),
      gravity_effect(),
      body_force_effect(),
      traction_effect(),
      spring_foundation_effect(),
      wall_contact_effect(),
      rigid_obstacles_effect(),
      prescribed_motion_effect(),
      contact_effect(),
      wall_friction_effect(),
      wall_release_effect(),
      hydrostatic_start_effect(),
      probes_effect(),
      adaptivity_effect(),
      audit_effect(),
    };
    return table;
  }
} // namespace selkie
