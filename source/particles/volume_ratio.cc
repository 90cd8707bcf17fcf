#include <selkie/particles/volume_ratio.h>

namespace selkie
{
  template <int dim>
  double
  volume_ratio(const ParticleSet<dim>                &particles,
               const dealii::ArrayView<const double> &properties)
  {
    const auto &columns = particles.columns;
    const auto &body =
      particles.scene
        .bodies[static_cast<unsigned int>(columns.body(properties))];
    return body.law->phase() == Phase::fluid
             ? columns.J(properties)
             : dealii::determinant(columns.F(properties));
  }


  template double
  volume_ratio(const ParticleSet<2> &, const dealii::ArrayView<const double> &);
  template double
  volume_ratio(const ParticleSet<3> &, const dealii::ArrayView<const double> &);
} // namespace selkie
