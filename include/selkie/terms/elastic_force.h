#pragma once

#include <selkie/laws/hyperelastic_law.h>
#include <selkie/terms/patch_state.h>

namespace selkie
{
  /// The force R_a = V_0 tau g_a of a point of an elastic solid, and its
  /// tangent by the paper's (B16)-(B17).
  /// @param response_at HyperelasticResponse at given Invariants: of the whole
  ///   law or of its part
  template <int dim, typename ResponseAt>
  void
  add_elastic_stress(PatchState<dim>   &state,
                     const unsigned int q,
                     const ResponseAt  &response_at,
                     const bool         with_tangent)
  {
    using dealii::Tensor;
    const StepPoint<dim> &point = state.point(q);
    const auto           &kin   = state.kinematics[q];
    const Tensor<2, 3>    F     = kin.f * extend(point.F_n);
    const Tensor<2, 3>    b     = left_cauchy_green(F);

    const HyperelasticResponse response =
      response_at(invariants(b, determinant(F)));
    const Tensor<2, 3> tau = kirchhoff_stress(response, b);
    state.forms[q].add_stress(point.volume, tau, kin);
    if (with_tangent)
      state.forms[q].add_tangent(
        point.volume,
        kin,
        [&](const Tensor<1, 3> &g_a, const Tensor<1, 3> &g_b) {
          return hyperelastic_tangent(response, tau, b, g_a, g_b);
        });
  }
} // namespace selkie
