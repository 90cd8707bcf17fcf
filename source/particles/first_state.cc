#include <selkie/base/exceptions.h>
#include <selkie/laws/volumetric_law.h>
#include <selkie/particles/first_state.h>
#include <selkie/scene/check_scene.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  namespace
  {
    /// Central differences with step @p h (m): exact for quadratic fields.
    template <int dim>
    dealii::Tensor<2, dim>
    gradient(const VectorExpression<dim> &field,
             const dealii::Point<dim>    &x,
             const double                 h)
    {
      dealii::Tensor<2, dim> result;
      for (unsigned int j = 0; j < dim; ++j)
        {
          dealii::Point<dim> ahead = x, behind = x;
          ahead[j] += h;
          behind[j] -= h;
          const auto difference =
            field.value(ahead, 0., ahead) - field.value(behind, 0., behind);
          for (unsigned int i = 0; i < dim; ++i)
            result[i][j] = difference[i] / (2. * h);
        }
      return result;
    }

    /// The part of a loaded face (m^2; m in 2D) that a point carries: that of
    /// its lattice cell if the point is of the layer next to the face.
    template <int dim>
    double
    traction_area(const Scene<dim> &scene, const Seed<dim> &seed)
    {
      const double spacing = std::pow(seed.volume, 1. / dim);
      for (const auto &traction : scene.tractions)
        if (traction.body == seed.body)
          {
            const auto box = scene.bodies[seed.body].shape->bounding_box();
            const unsigned int d = traction.face / 2;
            const double       plane =
              traction.face % 2 == 0 ? box.lower_bound(d) : box.upper_bound(d);
            if (std::abs(seed.x[d] - plane) < spacing)
              return seed.volume / spacing;
          }
      return 0.;
    }

    /// The pressure of a point, and the volume ratio that belongs to it.
    template <int dim>
    void
    set_first_pressure(const Scene<dim>                &scene,
                       const ParticleColumns<dim>      &columns,
                       const Body<dim>                 &body,
                       const VolumetricLaw             &law,
                       const dealii::Point<dim>        &X,
                       const dealii::ArrayView<double> &properties)
    {
      if (!body.initial_pressure)
        {
          columns.pressure.set(properties, law.pressure(1.));
          return;
        }
      const std::string parameter = "Bodies/" + body.name + "/Initial pressure";
      const double      p         = body.initial_pressure->value(X, 0., X);
      if (!std::isfinite(p))
        fail(scene,
             parameter,
             "not finite in the body; allowed are functions "
             "that are");
      try
        {
          columns.J.set(properties, law.J_of_pressure(p));
          columns.pressure.set(properties, p);
        }
      catch (const NumericalFailure &failure)
        {
          fail(scene, parameter, failure.what());
        }
    }
  } // namespace


  template <int dim>
  void
  set_first_state(const Scene<dim>                &scene,
                  const ParticleColumns<dim>      &columns,
                  const Seed<dim>                 &seed,
                  const dealii::ArrayView<double> &properties)
  {
    const Body<dim> &body = scene.bodies[seed.body];
    std::fill(properties.begin(), properties.end(), 0.);
    columns.body.set(properties, seed.body);
    columns.mass.set(properties, body.law->density() * seed.volume);
    columns.volume.set(properties, seed.volume);
    if (columns.X.exists())
      columns.X.set(properties, seed.x);
    if (columns.v.exists() && body.initial_velocity)
      columns.v.set(properties,
                    body.initial_velocity->value(seed.x, 0., seed.x));
    if (columns.grad_v.exists() && body.initial_velocity)
      columns.grad_v.set(properties,
                         gradient(*body.initial_velocity,
                                  seed.x,
                                  0.1 * std::pow(seed.volume, 1. / dim)));
    if (columns.traction_area.exists())
      columns.traction_area.set(properties, traction_area(scene, seed));
    if (columns.F.exists())
      columns.F.set(properties, dealii::unit_symmetric_tensor<dim>());
    if (columns.J.exists())
      columns.J.set(properties, 1.);
    if (const auto *law = dynamic_cast<const VolumetricLaw *>(body.law.get());
        law != nullptr && columns.pressure.exists())
      set_first_pressure(scene, columns, body, *law, seed.x, properties);
    if (columns.mean_J.exists())
      columns.mean_J.set(properties, 1.);
  }


#define INSTANTIATE(dim)                                      \
  template void set_first_state(const Scene<dim> &,           \
                                const ParticleColumns<dim> &, \
                                const Seed<dim> &,            \
                                const dealii::ArrayView<double> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
