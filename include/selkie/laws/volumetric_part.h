#pragma once

#include <selkie/laws/fluid_law.h>
#include <selkie/laws/hyperelastic_law.h>

namespace selkie
{
  /// How volume and pressure of matter in mixed form belong together, for
  /// fluids and solids alike.
  /// @param law a FluidLaw or a DecoupledLaw (not checked)
  inline const VolumetricLaw &
  volumetric_part(const Law &law)
  {
    if (law.phase() == Phase::fluid)
      return static_cast<const FluidLaw &>(law);
    return static_cast<const DecoupledLaw &>(law);
  }
} // namespace selkie
