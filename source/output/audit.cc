#include <selkie/laws/fluid_law.h>
#include <selkie/laws/hyperelastic_law.h>
#include <selkie/output/audit.h>
#include <selkie/transfer/transfer.h>

#include <deal.II/base/mpi.templates.h> // all_reduce of own types

#include <algorithm>
#include <cmath>

namespace selkie
{
  namespace
  {
    /// The laws of the bodies, as what they are; nullptr for the other kind.
    struct LawOfBody
    {
      const HyperelasticLaw *solid = nullptr;
      const FluidLaw        *fluid = nullptr;
    };

    template <int dim>
    std::vector<LawOfBody>
    laws_of_bodies(const Scene<dim> &scene)
    {
      std::vector<LawOfBody> laws;
      for (const Body<dim> &body : scene.bodies)
        laws.push_back({dynamic_cast<const HyperelasticLaw *>(body.law.get()),
                        dynamic_cast<const FluidLaw *>(body.law.get())});
      return laws;
    }

    /// Adds a point's motion; `center` is the moment m x for now.
    template <int dim>
    void
    add_motion(const ParticleSet<dim>                &particles,
               const dealii::Point<dim>              &x,
               const dealii::ArrayView<const double> &properties,
               Audit                                 &sum)
    {
      const auto  &columns = particles.columns;
      const double m       = columns.mass(properties);
      sum.mass += m;
      for (unsigned int i = 0; i < dim; ++i)
        sum.center[i] += m * x[i];
      if (particles.scene.gravity)
        sum.potential -= m * (*particles.scene.gravity * x);
      if (!particles.scene.inertia)
        return;
      const dealii::Tensor<1, dim> v        = columns.v(properties);
      const dealii::Tensor<1, 3>   momentum = m * extend(v);
      sum.kinetic += 0.5 * m * v.norm_square();
      sum.momentum += momentum;
      sum.angular_momentum +=
        dealii::cross_product_3d(extend<dim>(x), momentum);
    }

    /// The deformation gradient that a solid's law saw: F or, with mean
    /// dilatation, (Jbar / J)^{1/3} F.
    template <int dim>
    Tensor<2, 3>
    elastic_gradient(const ParticleSet<dim>                &particles,
                     const dealii::ArrayView<const double> &properties,
                     const double                           J)
    {
      const auto        &columns = particles.columns;
      const Tensor<2, 3> F       = extend(columns.F(properties));
      return columns.mean_J.exists()
               ? Tensor<2, 3>(std::cbrt(columns.mean_J(properties) / J) * F)
               : F;
    }

    /// Adds a point's volume and stored energy.
    template <int dim>
    void
    add_deformation(const ParticleSet<dim>                &particles,
                    const LawOfBody                       &law,
                    const dealii::ArrayView<const double> &properties,
                    Audit                                 &sum)
    {
      const double V_0 = particles.columns.volume(properties);
      const double J   = volume_ratio(particles, properties);
      sum.volume += J * V_0;
      sum.min_J = std::min(sum.min_J, J);
      sum.max_J = std::max(sum.max_J, J);

      // The energies of an inverted point: not an exception on one rank only.
      double energy = std::numeric_limits<double>::infinity();
      if (J > 0. && law.solid)
        energy = law.solid->energy(
          invariants(elastic_gradient(particles, properties, J)));
      else if (J > 0. && law.fluid)
        energy = law.fluid->energy(J);
      (law.solid ? sum.strain : sum.compression) += V_0 * energy;
    }

    /// The audit of the points of two ranks.
    Audit
    combined(const Audit &a, const Audit &b)
    {
      Audit sum = a;
      sum.kinetic += b.kinetic;
      sum.strain += b.strain;
      sum.compression += b.compression;
      sum.potential += b.potential;
      sum.mass += b.mass;
      sum.volume += b.volume;
      sum.min_J = std::min(a.min_J, b.min_J);
      sum.max_J = std::max(a.max_J, b.max_J);
      sum.momentum += b.momentum;
      sum.angular_momentum += b.angular_momentum;
      sum.center += b.center;
      return sum;
    }

    /// @param for_each calls a function with position and properties of every
    /// owned point
    template <int dim, typename ForEach>
    Audit
    sum_of_points(const ParticleSet<dim> &particles, const ForEach &for_each)
    {
      const std::vector<LawOfBody> laws = laws_of_bodies(particles.scene);

      Audit mine;
      for_each([&](const dealii::Point<dim>              &x,
                   const dealii::ArrayView<const double> &properties) {
        const auto body =
          static_cast<unsigned int>(particles.columns.body(properties));
        add_motion(particles, x, properties, mine);
        add_deformation(particles, laws[body], properties, mine);
      });

      Audit sum =
        dealii::Utilities::MPI::all_reduce<Audit>(mine,
                                                  particles.communicator(),
                                                  combined);
      if (sum.mass > 0.)
        sum.center /= sum.mass;
      return sum;
    }
  } // namespace


  template <int dim>
  Audit
  audit(const ParticleSet<dim> &particles)
  {
    return sum_of_points(particles, [&](const auto &add) {
      for (const auto &point : particles.handler())
        add(point.get_location(), point.get_properties());
    });
  }


  template <int dim>
  Audit
  audit(const PointUpdate<dim> &update)
  {
    return sum_of_points(update.particles,
                         [&](const auto &add) { update.preview(add); });
  }


  namespace
  {
    template <int dim>
    void
    set_motion(const Audit &audit, Statistics &statistics)
    {
      const std::string unit = dim == 2 ? "kg/s" : "kg m/s";
      for (unsigned int i = 0; i < dim; ++i)
        statistics.set(component_column("momentum", i, unit),
                       audit.momentum[i]);
      for (unsigned int i = dim == 2 ? 2 : 0; i < 3; ++i)
        statistics.set(component_column("angular momentum",
                                        i,
                                        dim == 2 ? "kg m/s" : "kg m^2/s"),
                       audit.angular_momentum[i]);
    }
  } // namespace


  template <int dim>
  void
  set_columns(const Audit            &audit,
              const ParticleSet<dim> &particles,
              Statistics             &statistics)
  {
    const Scene<dim> &scene  = particles.scene;
    const std::string energy = dim == 2 ? " energy (J/m)" : " energy (J)";
    if (scene.inertia)
      statistics.set("kinetic" + energy, audit.kinetic);
    if (particles.columns.F.exists())
      statistics.set("strain" + energy, audit.strain);
    if (particles.columns.J.exists())
      statistics.set("compression" + energy, audit.compression);
    if (scene.gravity)
      statistics.set("potential" + energy, audit.potential);

    statistics.set(dim == 2 ? "mass (kg/m)" : "mass (kg)", audit.mass);
    statistics.set(dim == 2 ? "volume (m^2)" : "volume (m^3)", audit.volume);
    statistics.set("min J", audit.min_J);
    statistics.set("max J", audit.max_J);
    for (unsigned int i = 0; i < dim; ++i)
      statistics.set(component_column("center of mass", i, "m"),
                     audit.center[i]);
    if (scene.inertia)
      set_motion<dim>(audit, statistics);
  }


  template Audit
  audit(const ParticleSet<2> &);
  template Audit
  audit(const ParticleSet<3> &);
  template Audit
  audit(const PointUpdate<2> &);
  template Audit
  audit(const PointUpdate<3> &);

  template void
  set_columns(const Audit &, const ParticleSet<2> &, Statistics &);
  template void
  set_columns(const Audit &, const ParticleSet<3> &, Statistics &);
} // namespace selkie
