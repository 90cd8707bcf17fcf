#pragma once

namespace selkie
{
  /// What the stepper carries from step to step besides the nodes' fields.
  struct KeptNumbers
  {
    double volume_excess = 0; ///< of the volume correction's measure
    double moved = 0; ///< at most by any node since the mesh was made (m)
  };
} // namespace selkie
