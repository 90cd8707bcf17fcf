#pragma once

#include <selkie/scene/scene.h>

#include <limits>

namespace selkie
{
  /// What is to be expected of the steps to come, beside the first ones.
  struct Outlook
  {
    /// None will be larger (s).
    double largest_step = std::numeric_limits<double>::infinity();
    /// What a later step costs, relative to the first ones: more, since matter
    /// spreads and meets. The middle of what the shipped scenes show
    /// (doc/accuracy-and-time.md, "Forecasts").
    double growth = 1.25;
  };

  /**
   * What a scene says of its later steps. Fluids whose top stands above the
   * level at which all matter of the scene would lie at rest in the whole box
   * will fall, the first of it to the floor: a step becomes so small that
   * points of that speed, sqrt(2 g height), do not go too far. If they may meet
   * solids, Newton needs a third iteration where the first steps need two, and
   * Krylov's method more as well. Where less than a tenth of the height is to
   * be lost nothing falls: the fluid stands on something, and with no solid in
   * the scene its steps go on as they began. Nothing is known of imported
   * meshes.
   * @param farthest that a point may move in a step (m)
   */
  template <int dim>
  Outlook
  look_ahead(const Scene<dim> &scene, const double farthest);
} // namespace selkie
