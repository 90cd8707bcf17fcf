#include <selkie/laws/newtonian_fluid.h>
#include <selkie/particles/hydrostatic.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The smallest value of g.x over the corners of a box.
    template <int dim>
    double
    top_level(const BoundingBox<dim> &box, const Tensor<1, dim> &g)
    {
      double level = std::numeric_limits<double>::max();
      for (unsigned int v = 0; v < (1u << dim); ++v)
        level = std::min(level, g * Tensor<1, dim>(box.vertex(v)));
      return level;
    }
  } // namespace

  template <int dim>
  void
  set_hydrostatic_state(ParticleSet<dim> &particles)
  {
    const auto &scene   = particles.scene;
    const auto &columns = particles.columns;
    for (auto &particle : particles.handler())
      {
        const auto  properties = particle.get_properties();
        const auto &body =
          scene.bodies[static_cast<unsigned int>(columns.body(properties))];
        if (!body.hydrostatic_start)
          continue;
        const auto  &law = static_cast<const FluidLaw &>(*body.law);
        const double p =
          law.density() *
          (*scene.gravity * Tensor<1, dim>(particle.get_location()) -
           top_level(body.shape->bounding_box(), *scene.gravity));
        columns.pressure.set(properties, p);
        columns.J.set(properties, law.J_of_pressure(p));
      }
  }

  template void
  set_hydrostatic_state(ParticleSet<2> &);
  template void
  set_hydrostatic_state(ParticleSet<3> &);
} // namespace selkie
