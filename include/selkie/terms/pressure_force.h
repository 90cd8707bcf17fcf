#pragma once

#include <selkie/laws/fluid_law.h>
#include <selkie/laws/volumetric_law.h>
#include <selkie/terms/patch_state.h>

namespace selkie
{
  /// The volumetric part of a point in mixed u-p form (formulation.md, 4), of
  /// fluids and solids alike: with W = V_0 J
  ///   R_a = -W p g_a,  R_p,a = -V_0 N_a (J - J^(p)).
  /// Unlike J, the pressure has no memory.
  template <int dim>
  void
  add_pressure(PatchState<dim>     &state,
               const unsigned int   q,
               const VolumetricLaw &law,
               const bool           with_tangent)
  {
    using dealii::Tensor;
    const auto  &kin  = state.kinematics[q];
    auto        &form = state.forms[q];
    const double V_0  = state.point(q).volume;
    const double W    = V_0 * kin.J;

    form.add_stress(W * -kin.p, identity(), kin);
    form.p_source -= V_0 * (kin.J - law.J_of_pressure(kin.p));
    if (!with_tangent)
      return;
    form.add_tangent(
      V_0, kin, [&](const Tensor<1, 3> &g_a, const Tensor<1, 3> &g_b) {
        return pressure_tangent_displacement(kin.p, kin.J, 0., g_a, g_b);
      });
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        form.coupling[i][j] -= W * kin.c[j][i];
    form.p_stiffness += V_0 * law.dJ_dpressure(kin.p);
  }
} // namespace selkie
