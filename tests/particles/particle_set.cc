#include <selkie/base/exceptions.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/particles/particle_set.h>
#include <selkie/scene/effect.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include "../test_shapes.h"

namespace
{
  using namespace selkie;
  using dealii::Point;
  using dealii::Tensor;
  using dealii::Utilities::MPI::sum;

  template <int dim>
  Body<dim>
  make_body(const std::string                &name,
            std::shared_ptr<const Shape<dim>> shape,
            const Phase                       phase = Phase::fluid)
  {
    Body<dim> body;
    body.name         = name;
    body.law          = std::make_shared<test::TestLaw>(phase);
    body.shape        = shape;
    body.has_pressure = phase == Phase::fluid;
    return body;
  }

  template <int dim>
  Point<dim>
  everywhere(const double x)
  {
    Point<dim> p;
    for (unsigned int d = 0; d < dim; ++d)
      p[d] = x;
    return p;
  }

  /// One block of fluid in the graded domain.
  template <int dim>
  Scene<dim>
  block_scene()
  {
    Scene<dim> scene;
    scene.domain = test::graded_domain<dim>();
    scene.bodies = {
      make_body<dim>("water",
                     std::make_shared<test::Box<dim>>(everywhere<dim>(.12),
                                                      everywhere<dim>(.83)))};
    scene.inertia        = Inertia();
    scene.fluid_pressure = FluidPressure();
    scene.leaving        = LeavingPolicy::keep;
    return scene;
  }

  template <int dim>
  double
  total_mass(const ParticleSet<dim> &set)
  {
    double mass = 0;
    for (const auto &point : set.handler())
      mass += set.columns.mass(point.get_properties());
    return sum(mass, MPI_COMM_WORLD);
  }

  /// A number that tells whether all points are where they were.
  template <int dim>
  double
  position_sum(const ParticleSet<dim> &set)
  {
    double result = 0;
    for (const auto &point : set.handler())
      for (unsigned int d = 0; d < dim; ++d)
        result += std::sin(1. + point.get_id() % 1009) * (d + 1.) *
                  point.get_location()[d];
    return sum(result, MPI_COMM_WORLD);
  }

  template <int dim>
  unsigned long
  points_outside_their_cell(const ParticleSet<dim> &set)
  {
    unsigned long wrong = 0;
    for (const auto &point : set.handler())
      {
        const auto cell = point.get_surrounding_cell();
        wrong += !cell->is_locally_owned();
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double h = cell->extent_in_direction(d);
            const double s = point.get_reference_location()[d];
            wrong += s < 0. || s > 1.;
            wrong += std::abs(cell->vertex(0)[d] + s * h -
                              point.get_location()[d]) > 1e-12;
          }
      }
    return sum(wrong, MPI_COMM_WORLD);
  }

  /// All points get the same displacement.
  template <int dim>
  void
  shift(ParticleSet<dim> &set, const Tensor<1, dim> &by)
  {
    set.move(
      std::vector<Tensor<1, dim>>(set.handler().n_locally_owned_particles(),
                                  by));
  }
} // namespace


TEST(ParticleColumns, ExistOnlyWhenNeeded)
{
  Scene<2>           scene;
  ParticleFields     empty;
  ParticleColumns<2> none(scene, empty);
  EXPECT_TRUE(none.mass.exists() && none.lambda.exists());
  EXPECT_FALSE(none.X.exists() || none.v.exists() || none.F.exists() ||
               none.J.exists() || none.grad_v.exists() ||
               none.traction_area.exists());
  EXPECT_EQ(empty.n_components(), 5u);

  scene = block_scene<2>();
  ParticleFields     with_fluid;
  ParticleColumns<2> fluid(scene, with_fluid);
  EXPECT_TRUE(fluid.v.exists() && fluid.a.exists() && fluid.J.exists());
  EXPECT_FALSE(fluid.F.exists() || fluid.X.exists());

  scene.bodies.push_back(
    make_body<2>("gate", scene.bodies[0].shape, Phase::solid));
  scene.transfer.scheme = TransferScheme::tpic;
  scene.effects.push_back({"traction", find_effect("traction")->make<2>()});
  ParticleFields     with_all;
  ParticleColumns<2> all(scene, with_all);
  EXPECT_TRUE(all.F.exists() && all.X.exists() && all.grad_v.exists() &&
              all.traction_area.exists());
}

TEST(ParticleSetMPI, MassOfABoxIsExact)
{
  const Scene<2> scene = block_scene<2>();
  const auto     mesh  = make_background_mesh(scene.domain, MPI_COMM_WORLD);
  ParticleSet<2> set(scene, *mesh);
  set.seed();
  EXPECT_NEAR(total_mass(set), 1000. * .71 * .71, 1e-9);
  EXPECT_EQ(set.accounting.seeded, set.handler().n_global_particles());
  EXPECT_EQ(points_outside_their_cell(set), 0u);
}

TEST(ParticleSetMPI, MassOfABallIsExactAndPointsStayInside)
{
  Scene<3>   scene = block_scene<3>();
  const auto ball  = std::make_shared<test::Ball<3>>(everywhere<3>(.5), .31);
  scene.bodies     = {make_body<3>("ball", ball, Phase::solid)};
  scene.bodies[0].jitter = 0.8;
  scene.bodies[0].initial_velocity =
    std::make_shared<VectorExpression<3>>("2*x; y + Y; 1 + t");
  const auto     mesh = make_background_mesh(scene.domain, MPI_COMM_WORLD);
  ParticleSet<3> set(scene, *mesh);
  set.seed();
  EXPECT_NEAR(total_mass(set) / (1000. * ball->volume()), 1., 1e-12);
  EXPECT_EQ(points_outside_their_cell(set), 0u);
  for (const auto &point : set.handler())
    {
      const auto     p = point.get_properties();
      const Point<3> x = point.get_location();
      EXPECT_TRUE(ball->contains(x));
      EXPECT_EQ(Point<3>(set.columns.X(p)), x);
      EXPECT_NEAR(
        (set.columns.v(p) - Point<3>(2. * x[0], 2. * x[1], 1.)).norm(),
        0.,
        1e-14);
      EXPECT_EQ(set.columns.F(p)[1][1], 1.);
      EXPECT_EQ(set.columns.F(p)[1][2], 0.);
      EXPECT_EQ(set.columns.body(p), 0.);
    }
}

TEST(ParticleSetMPI, JitterAndIdsAreTheSameOnAnyPartition)
{
  Scene<2> scene         = block_scene<2>();
  scene.bodies[0].jitter = 0.5;
  const auto     mesh    = make_background_mesh(scene.domain, MPI_COMM_WORLD);
  ParticleSet<2> set(scene, *mesh);
  set.seed();
  const auto     alone = make_background_mesh(scene.domain, MPI_COMM_SELF);
  ParticleSet<2> serial(scene, *alone);
  serial.seed();
  std::map<unsigned int, Point<2>> expected;
  for (const auto &point : serial.handler())
    expected[point.get_id()] = point.get_location();
  EXPECT_EQ(expected.size(), serial.accounting.seeded);
  EXPECT_EQ(expected.rbegin()->first, serial.accounting.seeded - 1);
  EXPECT_EQ(set.accounting.seeded, serial.accounting.seeded);
  unsigned int wrong = 0;
  for (const auto &point : set.handler())
    wrong += expected.at(point.get_id()) != point.get_location();
  EXPECT_EQ(wrong, 0u);
}

TEST(ParticleSetMPI, PartitionFollowsThePoints)
{
  Scene<2> scene = block_scene<2>();
  scene.domain.refinements.clear();
  scene.domain.cells = {{32, 32}};
  scene.bodies[0].shape =
    std::make_shared<test::Box<2>>(Point<2>(), Point<2>(.5, .5));
  const auto     mesh = make_background_mesh(scene.domain, MPI_COMM_WORLD);
  ParticleSet<2> set(scene, *mesh);
  set.seed();
  const unsigned int ranks =
    dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  // 17 for a point and one for each cell, empty ones included; p4est does
  // not part the four children of a cell.
  const double mine = 17. * set.handler().n_locally_owned_particles() +
                      mesh->n_locally_owned_active_cells();
  const double total = 17. * 1024. + 32. * 32.;
  EXPECT_NEAR(mine * ranks, total, 0.05 * total);
}

// A fluid's points cost 1.7 times what a solid's do (doc/performance.md).
TEST(ParticleSetMPI, PartitionFollowsWhatPointsCost)
{
  Scene<2> scene     = block_scene<2>();
  scene.domain       = Domain<2>();
  scene.domain.upper = everywhere<2>(1.);
  scene.domain.cells = {{32, 32}};
  const auto lower_half =
    std::make_shared<test::Box<2>>(Point<2>(0., 0.), Point<2>(1., 0.5));
  const auto upper_half =
    std::make_shared<test::Box<2>>(Point<2>(0., 0.5), Point<2>(1., 1.));
  scene.bodies        = {make_body<2>("bed", lower_half, Phase::solid),
                         make_body<2>("water", upper_half)};
  const auto     mesh = make_background_mesh(scene.domain, MPI_COMM_WORLD);
  ParticleSet<2> set(scene, *mesh);
  set.seed();
  double cost = 0.;
  for (const auto &point : set.handler())
    cost += set.columns.body(point.get_properties()) == 0 ? 1. : 1.7;
  const auto of_ranks =
    dealii::Utilities::MPI::min_max_avg(cost, MPI_COMM_WORLD);
  EXPECT_NEAR(set.imbalance(), of_ranks.max / of_ranks.avg, 1e-12);
  EXPECT_LT(set.imbalance(), 1.05); // by points alone it is 1.26 on two ranks
}

TEST(ParticleSetMPI, BadBodiesAreNamedOnAllRanks)
{
  Scene<2>   scene = block_scene<2>();
  const auto mesh  = make_background_mesh(scene.domain, MPI_COMM_WORLD);
  scene.bodies.push_back(make_body<2>(
    "stone",
    std::make_shared<test::Box<2>>(Point<2>(.8, .8), Point<2>(.95, .95))));
  const auto message = [&scene, &mesh]() {
    try
      {
        ParticleSet<2>(scene, *mesh).seed();
      }
    catch (const SceneError &error)
      {
        return std::string(error.what());
      }
    return std::string();
  };
  EXPECT_NE(message().find("'water' and 'stone' overlap"), std::string::npos);
  scene.bodies[1].shape =
    std::make_shared<test::Box<2>>(Point<2>(.91, .91), Point<2>(.911, .911));
  EXPECT_NE(message().find("'stone' gets no material point"),
            std::string::npos);
}

TEST(ParticleSetMPI, PoliciesForLeavingPoints)
{
  Scene<2>     scene = block_scene<2>();
  const auto   by    = Point<2>(.3, 0.); // 0.13 too far
  const double mass  = 1000. * .71 * .71;
  for (const auto policy :
       {LeavingPolicy::stop, LeavingPolicy::keep, LeavingPolicy::remove})
    {
      scene.leaving       = policy;
      const auto     mesh = make_background_mesh(scene.domain, MPI_COMM_WORLD);
      ParticleSet<2> set(scene, *mesh);
      set.seed();
      unsigned long long n = 0;
      for (const auto &point : set.handler())
        n += point.get_location()[0] + by[0] > 1.;
      n = sum(n, MPI_COMM_WORLD);
      EXPECT_GT(n, 0u);
      const double before = position_sum(set);
      std::string  message;
      try
        {
          shift(set, by);
        }
      catch (const NumericalFailure &failure)
        {
          message = failure.what();
        }
      const bool stop = policy == LeavingPolicy::stop;
      EXPECT_EQ(stop, message.find("of body 'water'") != std::string::npos);
      if (stop)
        {
          EXPECT_EQ(position_sum(set), before); // nothing has moved
        }
      EXPECT_EQ(set.accounting.kept_at_wall,
                policy == LeavingPolicy::keep ? n : 0u);
      EXPECT_EQ(set.accounting.removed,
                policy == LeavingPolicy::remove ? n : 0u);
      EXPECT_EQ(set.handler().n_global_particles(),
                set.accounting.seeded - set.accounting.removed);
      EXPECT_NEAR(total_mass(set) + set.accounting.removed_mass, mass, 1e-9);
      double right = 0;
      for (const auto &point : set.handler())
        right = std::max(right, point.get_location()[0]);
      EXPECT_LE(dealii::Utilities::MPI::max(right, MPI_COMM_WORLD),
                1. - set.wall_margin() * (1. - 1e-9));
      EXPECT_EQ(points_outside_their_cell(set), 0u);
    }
}

TEST(ParticleSetMPI, DisplacementThatIsNotFiniteIsAFailure)
{
  const Scene<2> scene = block_scene<2>();
  const auto     mesh  = make_background_mesh(scene.domain, MPI_COMM_WORLD);
  ParticleSet<2> set(scene, *mesh);
  set.seed();
  std::vector<Tensor<1, 2>> by(set.handler().n_locally_owned_particles());
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    by.at(0)[1] = std::nan("");
  EXPECT_THROW(set.move(by), NumericalFailure);
  EXPECT_EQ(points_outside_their_cell(set), 0u);
}

TEST(ParticleSetMPI, PointsOnEveryVertexAndFaceAreKept)
{
  // all points are put on a lattice of vertices, then of face midpoints
  for (const double offset : {0., 0.5})
    {
      const Scene<3> scene = block_scene<3>();
      const auto     mesh  = make_background_mesh(scene.domain, MPI_COMM_WORLD);
      ParticleSet<3> set(scene, *mesh);
      set.seed();
      for (auto &point : set.handler())
        {
          Point<3> x = point.get_location();
          for (unsigned int d = 0; d < 3; ++d)
            x[d] = (std::round(x[d] * 6.) + (d == 0 ? offset : 0.)) / 6.;
          x[0] = std::min(x[0], 1.);
          point.set_location(x);
        }
      set.sort(); // throws when a point is missing
      EXPECT_EQ(points_outside_their_cell(set), 0u);
    }
}

TEST(ParticleSetMPI, WalkOfTenThousandPoints)
{
  Scene<2> scene                       = block_scene<2>();
  scene.bodies[0].points_per_direction = 8;
  const auto     mesh = make_background_mesh(scene.domain, MPI_COMM_WORLD);
  ParticleSet<2> set(scene, *mesh);
  set.seed();
  EXPECT_GT(set.accounting.seeded, 9000u);
  const double mass = total_mass(set);
  const double h    = 0.1; // the coarse cells; the finest have h / 4

  // where a point goes depends on its id and the step only; some steps go to
  // a face or a vertex, some over several cells and ranks
  const auto next = [h](const unsigned int id, const int step, Point<2> x) {
    std::minstd_rand random(977 * id + 7919 * step + 1);
    const auto       uniform = [&random]() {
      random();
      return 2. * (random() % 100003) / 100002. - 1.;
    };
    const int    kind  = (id + step) % 4;
    const double reach = (step % 3 == 0) ? 3. * h : 0.3 * h;
    Point<2>     y;
    for (unsigned int d = 0; d < 2; ++d)
      {
        y[d] = x[d] + reach * uniform();
        if (y[d] < 0.02 || y[d] > 0.98)
          y[d] = 0.5 + 0.4 * uniform();
        if (kind == 1 || (kind == 2 && d == id % 2))
          y[d] = std::clamp(std::round(y[d] / (h / 4)), 1., 39.) * (h / 4);
      }
    return y;
  };
  std::vector<double> list;
  for (const auto &point : set.handler())
    for (const double entry : {double(point.get_id()),
                               point.get_location()[0],
                               point.get_location()[1]})
      list.push_back(entry);
  std::map<unsigned int, Point<2>> expected;
  for (const auto &part :
       dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, list))
    for (unsigned int i = 0; i < part.size(); i += 3)
      expected[part[i]] = Point<2>(part[i + 1], part[i + 2]);

  for (int step = 0; step < 200; ++step)
    {
      std::vector<Tensor<1, 2>> by;
      for (const auto &point : set.handler())
        by.push_back(next(point.get_id(), step, point.get_location()) -
                     point.get_location());
      set.move(by); // throws when count or mass changed
      for (auto &[id, x] : expected)
        x += next(id, step, x) - x;
      if (step % 50 == 49)
        set.rebalance();
    }
  unsigned long wrong = 0;
  for (const auto &point : set.handler())
    wrong += expected.at(point.get_id()).distance(point.get_location()) > 0.;
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(set.handler().n_global_particles(), expected.size());
  EXPECT_NEAR(total_mass(set) / mass, 1., 1e-12);
  EXPECT_EQ(set.accounting.kept_at_wall, 0u);
  EXPECT_EQ(points_outside_their_cell(set), 0u);
}
