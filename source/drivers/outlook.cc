#include <selkie/drivers/outlook.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The work of gravity on a kilogram that falls from the top of the highest
    /// fluid to the floor, if anything does (J/kg).
    template <int dim>
    double
    fall(const Scene<dim> &scene)
    {
      if (!scene.gravity)
        return 0.;
      const Tensor<1, dim>  &g = *scene.gravity;
      const BoundingBox<dim> box({scene.domain.lower, scene.domain.upper});
      const double           floor = -top_level(box, Tensor<1, dim>(-g));
      const double           depth = floor - top_level(box, g);

      double highest = floor, filled = 0.;
      for (const auto &body : scene.bodies)
        {
          filled += body.shape->volume() / box.volume();
          if (body.law->phase() == Phase::fluid)
            highest =
              std::min(highest, top_level(body.shape->bounding_box(), g));
        }
      const double sinks = floor - filled * depth - highest;
      return sinks > 0.1 * (floor - highest) ? floor - highest : 0.;
    }
  } // namespace


  template <int dim>
  Outlook
  look_ahead(const Scene<dim> &scene, const double farthest)
  {
    Outlook result;
    if (scene.domain.mesh)
      return result;
    const double work = fall(scene);
    if (work > 0.)
      {
        result.largest_step = farthest / std::sqrt(2. * work);
        if (scene.has_solid())
          result.growth = 1.6;
      }
    else if (!scene.has_solid())
      result.growth = 1.;
    return result;
  }

  template Outlook
  look_ahead(const Scene<2> &, const double);
  template Outlook
  look_ahead(const Scene<3> &, const double);
} // namespace selkie
