#include <selkie/laws/kinematics.h>
#include <selkie/particles/rearrange.h>
#include <selkie/particles/volume_ratio.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    // None of these limits is a size that points of a regular lattice have:
    // there round-off, and with it the number of ranks, would decide.

    /// Points that are larger than this are split, in lattice spacings of
    /// their cell: one from a cell twice as wide has 2.
    constexpr double large = 1.55;
    /// Those that are smaller than this may be merged: one from a cell half as
    /// wide has 0.5.
    constexpr double small = 0.74;
    /// Merged points have this volume at most, in lattice cells.
    constexpr double full = 1.3;

    template <int dim>
    using Iterator = Particles::ParticleIterator<dim>;

    /// The points of one body in one cell.
    template <int dim>
    struct Group
    {
      unsigned int               body;
      std::vector<Iterator<dim>> points;
    };

    /// What is to be done on this rank.
    template <int dim>
    struct Plan
    {
      std::vector<Iterator<dim>> parents; ///< to be split

      std::vector<Iterator<dim>>                     gone; ///< merged
      std::vector<typename ParticleSet<dim>::Record> born; ///< of the merges
      unsigned long long                             n_merged = 0;
    };

    template <int dim>
    double
    volume(const ParticleSet<dim>        &particles,
           const ArrayView<const double> &properties)
    {
      return particles.columns.volume(properties) *
             volume_ratio(particles, properties);
    }

    /// The points of each cell and body, in the order of their ids.
    template <int dim>
    std::vector<Group<dim>>
    groups_in(ParticleSet<dim> &particles)
    {
      std::vector<Group<dim>> groups;
      const auto             &handler = particles.handler();
      for (auto point = particles.handler().begin();
           point != particles.handler().end();)
        {
          const auto cell = point->get_surrounding_cell();
          std::map<unsigned int, std::vector<Iterator<dim>>> of_body;
          for (unsigned int i = handler.n_particles_in_cell(cell); i > 0; --i)
            of_body[static_cast<unsigned int>(
                      particles.columns.body(point->get_properties()))]
              .push_back(point++);
          for (auto &[body, points] : of_body)
            {
              std::sort(points.begin(),
                        points.end(),
                        [](const auto &a, const auto &b) {
                          return a->get_id() < b->get_id();
                        });
              groups.push_back({body, std::move(points)});
            }
        }
      return groups;
    }

    /// Points on the faces of places: see above.
    constexpr double off_the_faces = 1e-7;

    /// The place in the seeding's lattice of n^dim points of the cell.
    template <int dim>
    unsigned int
    lattice_place(const Point<dim> &reference, const unsigned int n)
    {
      unsigned int place = 0;
      for (unsigned int d = dim; d-- > 0;)
        place = place * n +
                static_cast<unsigned int>(
                  std::clamp(n * reference[d] + off_the_faces, 0., n - 1.));
      return place;
    }

    /// The spin that some points have about their centre of mass.
    template <int dim>
    Tensor<1, 3>
    spin(const ParticleSet<dim>                  &particles,
         const std::vector<Iterator<dim>>        &points,
         const typename ParticleSet<dim>::Record &together)
    {
      const auto  &columns = particles.columns;
      const auto   mean    = make_array_view(together.properties);
      Tensor<1, 3> sum;
      for (const auto &point : points)
        {
          const auto mine = point->get_properties();
          sum +=
            columns.mass(mine) *
            cross_product_3d(extend<dim>(point->get_location() - together.x),
                             extend<dim>(columns.v(mine) - columns.v(mean)));
        }
      return sum;
    }

    /// One point in the place of several of a body.
    template <int dim>
    typename ParticleSet<dim>::Record
    together(const ParticleSet<dim>           &particles,
             const std::vector<Iterator<dim>> &points)
    {
      const auto                       &columns = particles.columns;
      typename ParticleSet<dim>::Record one;
      one.id = points.front()->get_id();
      one.properties.assign(particles.fields.n_components(), 0.);
      double         V_0 = 0., V = 0.;
      Tensor<1, dim> center;
      for (const auto &point : points)
        {
          V_0 += columns.volume(point->get_properties());
          V += volume<dim>(particles, point->get_properties());
        }
      for (const auto &point : points)
        {
          const auto   mine  = point->get_properties();
          const double share = columns.volume(mine) / V_0;
          center += share * point->get_location();
          for (const auto &entry : particles.fields.entries())
            for (unsigned int i = entry.offset;
                 i < entry.offset + entry.n_components;
                 ++i)
              switch (entry.combine)
                {
                  case Combine::mean:
                    one.properties[i] += share * mine[i];
                    break;
                  case Combine::sum:
                    one.properties[i] += mine[i];
                    break;
                  case Combine::label:
                    one.properties[i] = mine[i];
                    break;
                }
        }
      one.x             = Point<dim>(center);
      const auto merged = make_array_view(one.properties);
      if (columns.F.exists())
        {
          const Tensor<2, dim> F = columns.F(merged);
          const double         J = determinant(F);
          if (J > 0.)
            columns.F.set(merged, std::pow(V / V_0 / J, 1. / dim) * F);
        }
      return one;
    }

    /// The small points of each place of the lattice that fill it together.
    template <int dim>
    std::vector<std::vector<Iterator<dim>>>
    fitting(const ParticleSet<dim> &particles, const Group<dim> &group)
    {
      const unsigned int n =
        particles.scene.bodies[group.body].points_per_direction;
      const double place_volume =
        group.points.front()->get_surrounding_cell()->measure() /
        Utilities::pow(n, dim);

      struct Place
      {
        std::vector<Iterator<dim>> points;
        double                     volume = 0;
      };
      std::map<unsigned int, Place> places;
      for (const auto &point : group.points)
        {
          const double V = volume<dim>(particles, point->get_properties());
          Place       &place =
            places[lattice_place(point->get_reference_location(), n)];
          if (V > std::pow(small, dim) * place_volume ||
              place.volume + V > full * place_volume)
            continue;
          place.points.push_back(point);
          place.volume += V;
        }
      std::vector<std::vector<Iterator<dim>>> result;
      for (auto &[index, place] : places)
        if (place.points.size() > 1)
          result.push_back(std::move(place.points));
      return result;
    }

    /// Points that can be turned: where and how heavy, and their properties.
    template <int dim>
    struct Turned
    {
      Point<dim>        x;
      ArrayView<double> properties;
    };

    /// Turns points about their centre of mass until they have so much more
    /// angular momentum; if they can take it.
    template <int dim>
    void
    give_spin(const ParticleColumns<dim>     &columns,
              const Tensor<1, 3>             &spin,
              const std::vector<Turned<dim>> &points)
    {
      double         mass = 0.;
      Tensor<1, dim> center;
      for (const auto &point : points)
        {
          mass += columns.mass(point.properties);
          center += columns.mass(point.properties) * point.x;
        }
      center /= mass;
      Tensor<2, 3> inertia;
      for (const auto &point : points)
        {
          const Tensor<1, 3> r = extend<dim>(point.x - center);
          inertia += columns.mass(point.properties) *
                     (r * r * unit_symmetric_tensor<3>() - outer_product(r, r));
        }
      if (dim == 2) // the plane turns about its normal only
        for (unsigned int d = 0; d < 2; ++d)
          inertia[d][d] = inertia[2][2];
      if (dim == 2)
        inertia[0][1] = inertia[1][0] = 0.;
      if (!(determinant(inertia) > 1e-6 * std::pow(trace(inertia) / 3., 3)))
        return;
      const Tensor<1, 3> omega = invert(inertia) * spin;
      for (const auto &point : points)
        {
          const Tensor<1, 3> turn =
            cross_product_3d(omega, extend<dim>(point.x - center));
          Tensor<1, dim> v = columns.v(point.properties);
          for (unsigned int d = 0; d < dim; ++d)
            v[d] += turn[d];
          columns.v.set(point.properties, v);
        }
    }

    /// Plans the merges of one body in one cell, and gives the points that
    /// will be there the spin that the merges take away.
    template <int dim>
    void
    plan_merges(const ParticleSet<dim> &particles,
                const Group<dim>       &group,
                Plan<dim>              &plan)
    {
      const auto        sets  = fitting(particles, group);
      const std::size_t first = plan.born.size();
      std::vector<bool> goes(group.points.size(), false);
      Tensor<1, 3>      lost;
      for (const auto &set : sets)
        {
          plan.born.push_back(together(particles, set));
          plan.gone.insert(plan.gone.end(), set.begin(), set.end());
          plan.n_merged += set.size() - 1;
          if (particles.columns.v.exists())
            lost += spin(particles, set, plan.born.back());
          for (const auto &point : set)
            goes[std::find(group.points.begin(), group.points.end(), point) -
                 group.points.begin()] = true;
        }
      if (sets.empty() || !particles.columns.v.exists())
        return;
      std::vector<Turned<dim>> present;
      for (std::size_t i = first; i < plan.born.size(); ++i)
        present.push_back(
          {plan.born[i].x, make_array_view(plan.born[i].properties)});
      for (unsigned int i = 0; i < group.points.size(); ++i)
        if (!goes[i])
          {
            auto point = group.points[i];
            present.push_back({point->get_location(), point->get_properties()});
          }
      if (present.size() > 1)
        give_spin(particles.columns, lost, present);
    }

    template <int dim>
    void
    plan_splits(const ParticleSet<dim> &particles,
                const Group<dim>       &group,
                Plan<dim>              &plan)
    {
      const double place =
        group.points.front()->get_surrounding_cell()->diameter() /
        std::sqrt(dim) /
        particles.scene.bodies[group.body].points_per_direction;
      for (const auto &point : group.points)
        if (volume<dim>(particles, point->get_properties()) >
            std::pow(large * place, dim))
          plan.parents.push_back(point);
    }

    /// How far children may lie from a point, by direction, for none of them
    /// to leave the domain: symmetric, so that their centre stays.
    template <int dim>
    Tensor<1, dim>
    room_around(const ParticleSet<dim> &particles, const Point<dim> &x)
    {
      const Domain<dim> &domain = particles.scene.domain;
      Tensor<1, dim>     room;
      for (unsigned int d = 0; d < dim; ++d)
        room[d] =
          std::max(0.,
                   std::min(x[d] - domain.lower[d], domain.upper[d] - x[d]) -
                     particles.wall_margin());
      return room;
    }

    /// The 2^dim parts of a point.
    template <int dim>
    std::vector<typename ParticleSet<dim>::Record>
    children_of(const ParticleSet<dim>     &particles,
                const Iterator<dim>        &parent,
                const types::particle_index first_new_id)
    {
      constexpr unsigned int n_children = 1u << dim;
      const auto            &columns    = particles.columns;
      const auto             mine       = parent->get_properties();
      const auto body = static_cast<unsigned int>(columns.body(mine));
      const bool solid =
        particles.scene.bodies[body].law->phase() == Phase::solid;
      // A fluid's F, if there is one, says nothing.
      const Tensor<2, dim> F =
        solid ? columns.F(mine)
              : Tensor<2, dim>(std::pow(columns.J(mine), 1. / dim) *
                               unit_symmetric_tensor<dim>());
      const double         side = std::pow(columns.volume(mine), 1. / dim);
      const Tensor<1, dim> room =
        room_around(particles, parent->get_location());

      std::vector<typename ParticleSet<dim>::Record> children(n_children);
      for (unsigned int c = 0; c < n_children; ++c)
        {
          auto &child      = children[c];
          child.id         = c == 0 ? parent->get_id() : first_new_id + c - 1;
          child.properties = {mine.begin(), mine.end()};
          const auto     properties = make_array_view(child.properties);
          Tensor<1, dim> dX;
          for (unsigned int d = 0; d < dim; ++d)
            dX[d] = ((c >> d) & 1u) ? side / 4. : -side / 4.;
          Tensor<1, dim> dx = F * dX;
          for (unsigned int d = 0; d < dim; ++d)
            dx[d] = std::clamp(dx[d], -room[d], room[d]);
          child.x = parent->get_location() + dx;
          for (const auto &entry : particles.fields.entries())
            if (entry.combine == Combine::sum)
              for (unsigned int i = 0; i < entry.n_components; ++i)
                child.properties[entry.offset + i] /= n_children;
          if (columns.X.exists())
            columns.X.set(properties, columns.X(mine) + dX);
          if (columns.grad_v.exists())
            columns.v.set(properties,
                          columns.v(mine) + columns.grad_v(mine) * dx);
        }
      return children;
    }

    /// For each of the ranks' points, its number among those of all ranks, in
    /// the order of ids.
    template <int dim>
    std::vector<unsigned long long>
    global_numbers(const std::vector<Iterator<dim>> &points,
                   const MPI_Comm                    comm)
    {
      std::vector<types::particle_index> mine, all;
      for (const auto &point : points)
        mine.push_back(point->get_id());
      for (const auto &ids : Utilities::MPI::all_gather(comm, mine))
        all.insert(all.end(), ids.begin(), ids.end());
      std::sort(all.begin(), all.end());
      std::vector<unsigned long long> numbers;
      for (const auto id : mine)
        numbers.push_back(std::lower_bound(all.begin(), all.end(), id) -
                          all.begin());
      return numbers;
    }
  } // namespace


  template <int dim>
  Rearrangement
  rearrange(ParticleSet<dim> &particles, const bool split, const bool merge)
  {
    Plan<dim> plan;
    for (const Group<dim> &group : groups_in(particles))
      {
        if (split)
          plan_splits(particles, group, plan);
        if (merge)
          plan_merges(particles, group, plan);
      }
    const MPI_Comm         comm       = particles.communicator();
    constexpr unsigned int n_children = 1u << dim;
    const auto             numbers    = global_numbers<dim>(plan.parents, comm);
    for (unsigned int i = 0; i < plan.parents.size(); ++i)
      {
        const auto children = children_of(particles,
                                          plan.parents[i],
                                          particles.accounting.next_id() +
                                            numbers[i] * (n_children - 1));
        plan.born.insert(plan.born.end(), children.begin(), children.end());
        plan.gone.push_back(plan.parents[i]);
      }
    Rearrangement result;
    result.split =
      Utilities::MPI::sum(static_cast<unsigned long long>(plan.parents.size()),
                          comm);
    result.merged = Utilities::MPI::sum(plan.n_merged, comm);
    if (result.split + result.merged > 0)
      particles.replace(plan.gone,
                        plan.born,
                        result.split * (n_children - 1),
                        result.merged);
    return result;
  }


  template Rearrangement
  rearrange(ParticleSet<2> &, const bool, const bool);
  template Rearrangement
  rearrange(ParticleSet<3> &, const bool, const bool);
} // namespace selkie
