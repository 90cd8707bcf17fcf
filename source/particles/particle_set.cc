#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/particles/first_state.h>
#include <selkie/particles/particle_set.h>
#include <selkie/scene/check_scene.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <unordered_set>

namespace selkie
{
  namespace
  {
    /// What a point of each body costs in a step, in tenths of what one without
    /// a pressure does: measured (doc/performance.md, "What a point costs"). An
    /// empty cell costs one.
    template <int dim>
    std::vector<unsigned int>
    costs_of_points(const Scene<dim> &scene)
    {
      std::vector<unsigned int> costs;
      for (const auto &body : scene.bodies)
        costs.push_back(body.has_pressure ? 17 : 10);
      return costs;
    }

    /// A point on its way from cell to cell or rank to rank: id, position and
    /// properties, all as doubles (ids are below 2^53).
    template <int dim, typename Properties>
    std::vector<double>
    pack(const dealii::types::particle_index id,
         const dealii::Point<dim>           &x,
         const Properties                   &properties)
    {
      std::vector<double> record = {static_cast<double>(id)};
      record.insert(record.end(), x.begin_raw(), x.end_raw());
      record.insert(record.end(), properties.begin(), properties.end());
      return record;
    }

    template <typename Particle>
    std::vector<double>
    pack(const Particle &point)
    {
      return pack(point.get_id(), point.get_location(), point.get_properties());
    }

    template <int dim>
    dealii::Point<dim>
    packed_position(const std::vector<double> &record)
    {
      dealii::Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = record[1 + d];
      return x;
    }
  } // namespace


  template <int dim>
  ParticleSet<dim>::ParticleSet(const Scene<dim> &scene, Mesh &mesh)
    : scene(scene)
    , columns(scene, fields)
    , mesh(mesh)
    , points(mesh, mapping, fields.n_components())
    , costs(costs_of_points(scene))
    , weight_connection(mesh.signals.weight.connect(
        [this](const auto &cell, const auto) { return weight(cell); }))
  {}


  template <int dim>
  ParticleSet<dim>::~ParticleSet() = default;


  template <int dim>
  void
  ParticleSet<dim>::seed()
  {
    accounting             = ParticleAccounting();
    accounting.seeded_mass = put_seeds();
    accounting.seeded      = points.n_global_particles();
    rebalance();
    displace_at_start();
  }


  template <int dim>
  double
  ParticleSet<dim>::put_seeds()
  {
    points.clear();
    std::vector<double> properties(fields.n_components());
    const auto          view  = dealii::make_array_view(properties);
    double              mass  = 0;
    const auto          seeds = seed_points(scene, mesh);
    fail_together<SceneError>(communicator(), [&] {
      for (const Seed<dim> &seed : seeds)
        {
          set_first_state(scene, columns, seed, view);
          mass += columns.mass(view);
          points.insert_particle(
            seed.x, seed.reference, seed.id, seed.cell, properties);
        }
    });
    points.update_cached_numbers();
    return dealii::Utilities::MPI::sum(mass, communicator());
  }


  template <int dim>
  void
  ParticleSet<dim>::displace_at_start()
  {
    std::vector<dealii::Tensor<1, dim>> displacements;
    const auto                          displaced =
      std::find_if(scene.bodies.begin(),
                   scene.bodies.end(),
                   [](const auto &body) { return body.initial_displacement; });
    if (displaced == scene.bodies.end())
      return;
    for (const auto &point : points)
      {
        const auto b =
          static_cast<unsigned int>(columns.body(point.get_properties()));
        const auto &function = scene.bodies[b].initial_displacement;
        const auto  X        = point.get_location();
        displacements.push_back(function ? function->value(X, 0., X)
                                         : dealii::Tensor<1, dim>());
      }
    try
      {
        move(displacements);
      }
    catch (const NumericalFailure &failure) // on all ranks
      {
        fail(scene,
             "Bodies/" + displaced->name + "/Initial displacement",
             std::string(failure.what()) +
               " Allowed are finite displacements that keep the points in the "
               "domain");
      }
  }


  template <int dim>
  template <typename Points>
  unsigned int
  ParticleSet<dim>::cost(const Points &some) const
  {
    unsigned int sum = 0;
    for (const auto &point : some)
      sum +=
        costs[static_cast<unsigned int>(columns.body(point.get_properties()))];
    return sum;
  }


  template <int dim>
  unsigned int
  ParticleSet<dim>::weight(const typename Mesh::cell_iterator &cell) const
  {
    if (cell->is_active())
      return 1 + cost(points.particles_in_cell(cell));
    unsigned int sum = 0;
    for (unsigned int c = 0; c < cell->n_children(); ++c)
      sum += cost(points.particles_in_cell(cell->child(c)));
    if (scene.lagrangian_mesh())
      sum /= cell->n_children(); // Gauss points of one element
    return 1 + sum;
  }


  template <int dim>
  double
  ParticleSet<dim>::imbalance() const
  {
    if (dealii::Utilities::MPI::n_mpi_processes(communicator()) == 1)
      return 1.;
    const auto of_ranks =
      dealii::Utilities::MPI::min_max_avg(double(cost(points)), communicator());
    return of_ranks.sum > 0. ? of_ranks.max / of_ranks.avg : 1.;
  }


  template <int dim>
  void
  ParticleSet<dim>::rebalance()
  {
    points.prepare_for_coarsening_and_refinement();
    mesh.repartition();
    points.unpack_after_coarsening_and_refinement();
    check_accounting();
  }


  template <int dim>
  void
  ParticleSet<dim>::rebalance(const CellWeight<dim> &weight)
  {
    const boost::signals2::shared_connection_block points_do_not_count(
      weight_connection);
    const boost::signals2::scoped_connection weight_counts(
      mesh.signals.weight.connect(
        [&weight](const auto &cell, const auto) { return weight(cell); }));
    rebalance();
  }


  template <int dim>
  void
  ParticleSet<dim>::remesh(const std::function<void()> &change)
  {
    if (scene.lagrangian_mesh())
      {
        points.clear();
        change();
        put_seeds();
        accounting.seeded = points.n_global_particles();
        check_accounting();
        return;
      }
    std::vector<std::vector<double>> records;
    records.reserve(points.n_locally_owned_particles());
    for (const auto &point : points)
      records.push_back(pack(point));
    points.clear();
    change();
    points.clear(); // makes room for the points of the new cells
    deliver(records);
    points.update_cached_numbers();
    check_accounting();
  }


  template <int dim>
  void
  ParticleSet<dim>::replace(const std::vector<Iterator> &gone,
                            const std::vector<Record>   &born,
                            const unsigned long long     split,
                            const unsigned long long     merged)
  {
    std::unordered_set<dealii::types::particle_index> ids;
    for (const auto &point : gone)
      ids.insert(point->get_id());
    std::vector<Iterator> in_order;
    for (auto point = points.begin(); point != points.end(); ++point)
      if (ids.count(point->get_id()) > 0)
        in_order.push_back(point);
    remove(in_order);

    std::vector<std::vector<double>> records;
    for (const Record &record : born)
      records.push_back(pack(record.id, record.x, record.properties));
    deliver(records);
    accounting.split += split;
    accounting.merged += merged;
    points.update_cached_numbers();
    check_accounting();
  }


  template <int dim>
  double
  ParticleSet<dim>::wall_margin() const
  {
    return 1e-5 * CellLocator<dim>(mesh).smallest_spacing();
  }


  template <int dim>
  std::string
  ParticleSet<dim>::describe(const Iterator           &point,
                             const dealii::Point<dim> &x) const
  {
    const unsigned int body = columns.body(point->get_properties());
    std::ostringstream out;
    out << "material point " << point->get_id() << " of body '"
        << scene.bodies[body].name << "', at (" << point->get_location()
        << "), would move to (" << x << ")";
    return out.str();
  }


  /// Not ParticleHandler::remove_particles(), which is collective. The points
  /// are in iteration order; going backwards keeps the iterators valid.
  template <int dim>
  void
  ParticleSet<dim>::remove(const std::vector<Iterator> &leaving)
  {
    for (auto point = leaving.rbegin(); point != leaving.rend(); ++point)
      points.remove_particle(*point);
  }


  template <int dim>
  void
  ParticleSet<dim>::insert(const std::vector<double>                 &record,
                           const typename CellLocator<dim>::Location &place)
  {
    points.insert_particle(
      packed_position<dim>(record),
      place.reference,
      static_cast<dealii::types::particle_index>(record[0]),
      place.cell,
      dealii::ArrayView<const double>(record.data() + 1 + dim,
                                      fields.n_components()));
  }


  template <int dim>
  void
  ParticleSet<dim>::sort()
  {
    const CellLocator<dim>           locator(mesh);
    std::vector<Iterator>            movers;
    std::vector<std::vector<double>> records;
    std::string                      outside;
    for (auto point = points.begin(); point != points.end(); ++point)
      {
        const dealii::Point<dim> x = point->get_location();
        for (unsigned int d = 0; d < dim; ++d)
          if (!(x[d] >= locator.lower()[d] && x[d] <= locator.upper()[d]))
            outside = describe(point, x);
        const auto place = locator.locate(x);
        if (place.cell == point->get_surrounding_cell())
          point->set_reference_location(place.reference);
        else
          {
            movers.push_back(point);
            records.push_back(pack(*point));
          }
      }
    throw_on_all_ranks<NumericalFailure>(
      communicator(),
      outside.empty() ? "" : "Outside the domain: the " + outside + ".");
    remove(movers);
    deliver(records);
    points.update_cached_numbers();
    check_accounting();
  }


  /// The ranks that own positions, none of them on a face, in cells that this
  /// rank does not know. deal.II's function is collective, contrary to what
  /// its manual says (it unites the manifold ids of all ranks), so that all
  /// ranks call it or none; and it finds no owner for some points on faces.
  template <int dim>
  std::vector<dealii::types::subdomain_id>
  ParticleSet<dim>::owners_of(
    const std::vector<dealii::Point<dim>> &positions) const
  {
    const unsigned int asks = positions.empty() ? 0 : 1;
    if (dealii::Utilities::MPI::max(asks, communicator()) == 0)
      return {};
    const auto  owners = mesh.find_point_owner_rank(positions);
    const auto  ranks = dealii::Utilities::MPI::n_mpi_processes(communicator());
    std::string error;
    for (const auto owner : owners)
      if (owner >= ranks)
        error = "Internal error: a material point has no owner.";
    throw_on_all_ranks<NumericalFailure>(communicator(), error);
    return owners;
  }


  /**
   * Puts points into their cells, on whatever rank. A rank that has a point's
   * cell as ghost knows its owner; for one further away p4est does. So one
   * exchange is enough; the loop is there to see that nothing is left.
   */
  template <int dim>
  void
  ParticleSet<dim>::deliver(const std::vector<std::vector<double>> &records)
  {
    const CellLocator<dim>           locator(mesh);
    std::vector<std::vector<double>> here = records;
    for (unsigned int round = 0; round < 3; ++round)
      {
        std::map<unsigned int, std::vector<std::vector<double>>> outgoing;
        std::vector<const std::vector<double> *>                 far_away;
        std::vector<dealii::Point<dim>>                          far_positions;
        for (const auto &record : here)
          {
            const auto x     = packed_position<dim>(record);
            const auto place = locator.locate(x);
            if (place.cell->is_locally_owned())
              insert(record, place);
            else if (place.cell->is_ghost())
              outgoing[place.cell->subdomain_id()].push_back(record);
            else
              {
                far_away.push_back(&record);
                far_positions.push_back(locator.inside_cell(x));
              }
          }
        const auto owners = owners_of(far_positions);
        for (unsigned int i = 0; i < far_away.size(); ++i)
          outgoing[owners[i]].push_back(*far_away[i]);
        const unsigned int sends = outgoing.empty() ? 0 : 1;
        if (dealii::Utilities::MPI::max(sends, communicator()) == 0)
          return;
        here.clear();
        for (const auto &[rank, received] :
             dealii::Utilities::MPI::some_to_some(communicator(), outgoing))
          here.insert(here.end(), received.begin(), received.end());
      }
    throw_on_all_ranks<NumericalFailure>(
      communicator(), "Internal error: material points find no owner.");
  }


  template <int dim>
  void
  ParticleSet<dim>::check_accounting() const
  {
    double mass = 0;
    for (const auto &point : points)
      mass += columns.mass(point.get_properties());
    mass                  = dealii::Utilities::MPI::sum(mass, communicator());
    const auto   n        = points.n_global_particles();
    const auto   expected = accounting.present();
    const double expected_mass =
      accounting.seeded_mass - accounting.removed_mass;
    if (n == expected &&
        std::abs(mass - expected_mass) <= 1e-9 * accounting.seeded_mass)
      return; // n and mass are the same on all ranks
    std::ostringstream out;
    out << "Internal error: there are " << n << " material points of " << mass
        << " kg, but there should be " << expected << " of " << expected_mass
        << " kg.";
    throw NumericalFailure(out.str());
  }


  template <int dim>
  dealii::Particles::ParticleHandler<dim> &
  ParticleSet<dim>::handler()
  {
    return points;
  }


  template <int dim>
  const dealii::Particles::ParticleHandler<dim> &
  ParticleSet<dim>::handler() const
  {
    return points;
  }


  template <int dim>
  MPI_Comm
  ParticleSet<dim>::communicator() const
  {
    return mesh.get_communicator();
  }


  // All but what particle_set_moves.cc has.
  template class ParticleSet<2>;
  template class ParticleSet<3>;
} // namespace selkie
