#include <selkie/shape/gather_points.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The state of a material point at t_n.
    template <int dim>
    StepPoint<dim>
    step_point(const ParticleSet<dim>                 &particles,
               const Particles::ParticleAccessor<dim> &particle,
               const unsigned int                      index)
    {
      const auto  properties = particle.get_properties();
      const auto &columns    = particles.columns;

      StepPoint<dim> point;
      point.x        = particle.get_location();
      point.body     = static_cast<unsigned int>(columns.body(properties));
      point.law      = particles.scene.bodies[point.body].law.get();
      point.mass     = columns.mass(properties);
      point.volume   = columns.volume(properties);
      point.particle = index;
      if (columns.lambda.exists())
        point.lambda = columns.lambda(properties);
      if (columns.X.exists())
        point.X = Point<dim>(columns.X(properties));
      if (columns.traction_area.exists())
        point.area = columns.traction_area(properties);
      if (columns.F.exists())
        point.F_n = columns.F(properties);
      if (point.law->phase() == Phase::fluid)
        point.J_n = columns.J(properties);
      else if (particles.scene.bodies[point.body].has_pressure)
        point.J_n = determinant(point.F_n);
      return point;
    }
  } // namespace

  template <int dim>
  void
  gather_points(const ParticleSet<dim> &particles, SupportTable<dim> &table)
  {
    table.clear();
    std::vector<StepPoint<dim>> in_cell;
    const auto                 &bodies   = particles.scene.bodies;
    auto                        particle = particles.handler().begin();
    while (particle != particles.handler().end())
      {
        const typename Triangulation<dim>::active_cell_iterator cell =
          particle->get_surrounding_cell();
        in_cell.clear();
        for (; particle != particles.handler().end() &&
               particle->get_surrounding_cell() == cell;
             ++particle)
          in_cell.push_back(
            step_point(particles, *particle, table.n_particles++));
        std::stable_sort(in_cell.begin(),
                         in_cell.end(),
                         [&](const auto &p, const auto &q) {
                           return bodies[p.body].phase < bodies[q.body].phase;
                         });

        for (unsigned int first = 0, last; first < in_cell.size(); first = last)
          {
            const unsigned int phase = bodies[in_cell[first].body].phase;
            last                     = first;
            while (last < in_cell.size() &&
                   bodies[in_cell[last].body].phase == phase)
              ++last;

            Patch<dim> patch;
            patch.cell        = cell;
            patch.phase       = phase;
            patch.fluid       = in_cell[first].law->phase() == Phase::fluid;
            patch.pressure    = bodies[in_cell[first].body].has_pressure;
            patch.first_point = table.points.size();
            patch.n_points    = last - first;
            table.points.insert(table.points.end(),
                                in_cell.begin() + first,
                                in_cell.begin() + last);
            table.patches.push_back(patch);
          }
      }
  }

  template void
  gather_points(const ParticleSet<2> &, SupportTable<2> &);
  template void
  gather_points(const ParticleSet<3> &, SupportTable<3> &);
} // namespace selkie
