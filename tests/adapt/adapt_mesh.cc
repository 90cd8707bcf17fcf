#include <selkie/adapt/adapt_mesh.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/output/audit.h>
#include <selkie/particles/rearrange.h>

#include <deal.II/base/mpi.h>
#include <deal.II/grid/cell_id.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <set>

#include "../small_scenes.h"

namespace
{
  using namespace selkie;
  using dealii::Point;
  using dealii::Tensor;

  const std::vector<std::string> adaptive = {
    "Effects=inertia, gravity, viscosity, adaptivity",
    "Points leaving=keep",
    "Adaptivity/Finer levels=2",
    "Adaptivity/Surface=true",
    "Adaptivity/Interface=true",
    "Adaptivity/Buffer=1"};

  /// Mesh and points of a scene on the ranks of a communicator.
  template <int dim>
  struct World
  {
    World(const Scene<dim> &scene, const MPI_Comm comm)
      : scene(scene)
      , mesh(make_background_mesh(scene.domain, comm))
      , particles(scene, *mesh)
    {
      particles.seed();
    }

    AdaptReport
    adapt()
    {
      CarriedFields<dim> none;
      const auto         plan =
        plan_adaptation(*mesh, particles, NodeCloud<dim>(*mesh, 3., 1e-6), {});
      return adapt_mesh(*mesh, particles, plan, none);
    }

    /// Moves every point as a field of position and step says; some, if
    /// wanted, to faces of cells.
    void
    move(const unsigned int step, const bool to_faces)
    {
      std::vector<Tensor<1, dim>> displacements;
      for (const auto &point : particles.handler())
        {
          const auto     x = point.get_location();
          Tensor<1, dim> u;
          for (unsigned int d = 0; d < dim; ++d)
            {
              u[d] = 0.02 * std::sin(7. * x[(d + 1) % dim] + 1.3 * step + d);
              if (to_faces && point.get_id() % 11 == 0) // of the coarse mesh
                u[d] = 0.1 * std::round((x[d] + u[d]) / 0.1) - x[d];
            }
          displacements.push_back(u);
        }
      particles.move(displacements);
    }

    std::set<std::string>
    cells() const
    {
      std::set<std::string> mine, all;
      for (const auto &cell : mesh->active_cell_iterators())
        if (cell->is_locally_owned())
          mine.insert(cell->id().to_string());
      const std::vector<std::string> list(mine.begin(), mine.end());
      for (const auto &part :
           dealii::Utilities::MPI::all_gather(mesh->get_communicator(), list))
        all.insert(part.begin(), part.end());
      return all;
    }

    /// Id and position of all points.
    std::map<unsigned long long, Point<dim>>
    points() const
    {
      std::map<unsigned long long, Point<dim>> mine, all;
      for (const auto &point : particles.handler())
        mine[point.get_id()] = point.get_location();
      for (const auto &part :
           dealii::Utilities::MPI::all_gather(mesh->get_communicator(), mine))
        all.insert(part.begin(), part.end());
      return all;
    }

    const Scene<dim>                                                  &scene;
    std::unique_ptr<dealii::parallel::distributed::Triangulation<dim>> mesh;
    ParticleSet<dim> particles;
  };

  unsigned int
  n_adaptations()
  {
    const char *wish = std::getenv("SELKIE_TEST_ADAPTATIONS");
    return wish != nullptr ? std::atoi(wish) : 30;
  }

  /// A block of water in the middle of a box.
  const char *const water_3d = R"(
set Title          = water
set Dimension      = 3
set Effects        = inertia, adaptivity
set Points leaving = keep
subsection Domain
  set Lower corner = 0, 0, 0
  set Upper corner = 0.6, 0.6, 0.6
  set Cells        = 6, 6, 6
end
subsection Bodies
  set Names = water
  subsection water
    set Law    = newtonian fluid
    set Shape  = box(0.1, 0.1, 0.1, 0.5, 0.5, 0.5)
    set Jitter = 0.2
    set Initial velocity = 0.3*y*x; 0.2*z; x
    subsection Law parameters
      set Density      = 1000
      set Bulk modulus = 2e5
    end
  end
end
subsection Adaptivity
  set Finer levels   = 1
  set Coarser levels = 1
  set Surface        = true
  set Buffer         = 1
end
subsection Time
  set End time = 0.1
  set Step     = 2e-3
end
)";

  template <int dim>
  void
  lose_nothing(const Scene<dim> &scene, const unsigned int n_adaptations)
  {
    World<dim>         world(scene, MPI_COMM_WORLD);
    unsigned long long split = 0, merged = 0;
    for (unsigned int step = 0; step < n_adaptations; ++step)
      {
        world.move(step, true);
        const Audit before = audit(world.particles);
        const auto  report = world.adapt();
        const Audit after  = audit(world.particles);
        // Ids are unique, the count is the one that is booked.
        const auto &booked = world.particles.accounting;
        const auto  n      = world.particles.handler().n_global_particles();
        ASSERT_EQ(n, booked.seeded + booked.split - booked.merged);
        if (step % 20 == 0)
          {
            ASSERT_EQ(world.points().size(), n);
          }
        ASSERT_NEAR(after.mass, before.mass, 1e-11 * before.mass);
        ASSERT_NEAR(after.volume, before.volume, 1e-11 * before.volume);
        const double p = std::sqrt(2. * before.mass * before.kinetic);
        ASSERT_LT((after.momentum - before.momentum).norm(), 1e-11 * p);
        ASSERT_LT(after.center.distance(before.center), 1e-12);
        EXPECT_LT((after.angular_momentum - before.angular_momentum).norm(),
                  1e-4 * p)
          << "step " << step;
        ASSERT_NEAR(report.energy,
                    after.energy() - before.energy(),
                    1e-9 * before.energy());
        split  = booked.split;
        merged = booked.merged;
      }
    EXPECT_GT(split, 0u);
    if (dim == 2) // the block in space is all surface
      {
        EXPECT_GT(merged, 0u);
      }
  }
} // namespace


/// The mesh and the points, their ids included, are those of one rank alone. No
/// points on faces here: their volumes have the round-off of a sum over the
/// ranks, and round-off would tell in which cell they are.
TEST(AdaptMeshMPI, IsTheSameOnAnyRanks)
{
  const auto scene =
    small_scenes::read<2>(small_scenes::fluid_on_solid(), adaptive);
  World<2> here(scene, MPI_COMM_WORLD), alone(scene, MPI_COMM_SELF);
  for (unsigned int step = 0; step < 12; ++step)
    {
      here.move(step, false);
      alone.move(step, false);
      here.adapt();
      alone.adapt();
      ASSERT_EQ(here.cells(), alone.cells()) << "step " << step;
      const auto mine = here.points(), theirs = alone.points();
      ASSERT_EQ(mine.size(), theirs.size()) << "step " << step;
      for (const auto &[id, x] : mine)
        {
          ASSERT_EQ(theirs.count(id), 1u) << "step " << step;
          ASSERT_LT(x.distance(theirs.at(id)), 1e-12) << "step " << step;
        }
    }
}


/// No point is lost, and what must stay stays, in many adaptations of a scene
/// that is stirred. (SELKIE_TEST_ADAPTATIONS: so many; the long test takes
/// 10000.)
TEST(AdaptMeshMPI, LosesNothing)
{
  lose_nothing(small_scenes::read<2>(small_scenes::fluid_on_solid(), adaptive),
               n_adaptations());
}


TEST(AdaptMeshMPI, LosesNothingIn3D)
{
  lose_nothing(small_scenes::read<3>(water_3d), 6);
}


/// The nodes of an adapted mesh: cells that share a corner differ by a level
/// at most, and so do the spacings at their corners.
TEST(AdaptMeshMPI, NeighboursDifferByOneLevel)
{
  const auto scene =
    small_scenes::read<2>(small_scenes::fluid_on_solid(), adaptive);
  World<2> world(scene, MPI_COMM_WORLD);
  for (unsigned int step = 0; step < 5; ++step)
    {
      world.move(step, true);
      world.adapt();
      const NodeCloud<2> cloud(*world.mesh, 3., 1e-6);
      for (const auto &cell : world.mesh->active_cell_iterators())
        if (cell->is_locally_owned())
          for (const unsigned int node : cloud.corners(cell))
            {
              const double ratio =
                cell->extent_in_direction(0) / cloud.spacing(node);
              EXPECT_TRUE(std::abs(ratio - 1.) < 1e-9 ||
                          std::abs(ratio - 2.) < 1e-9)
                << ratio;
            }
    }
}


/// One empty cell inside is a hole between points, four are a bubble.
TEST(AdaptMeshMPI, ASingleEmptyCellIsNoSurface)
{
  const auto level_inside = [](const std::string &hole) {
    const auto scene =
      small_scenes::read<2>(small_scenes::free_block(),
                            {"Effects=inertia, adaptivity",
                             "Domain/Cells=20, 20",
                             "Bodies/block/Shape=box(0.1, 0.1, 0.9, 0.9) - " +
                               hole,
                             "Adaptivity/Surface=true",
                             "Adaptivity/Finer levels=1",
                             "Adaptivity/Buffer=1"});
    World<2> world(scene, MPI_COMM_WORLD);
    world.adapt();
    int finest = 0;
    for (const auto &cell : world.mesh->active_cell_iterators())
      if (cell->is_locally_owned() &&
          cell->center().distance(Point<2>(0.5, 0.5)) < 0.2)
        finest = std::max(finest, cell->level());
    return dealii::Utilities::MPI::max(finest, MPI_COMM_WORLD);
  };
  EXPECT_EQ(level_inside("box(0.45, 0.45, 0.5, 0.5)"), 2);
  EXPECT_EQ(level_inside("box(0.45, 0.45, 0.55, 0.55)"), 3);
}


/// No more cells than the scene allows, and where the user has put a box they
/// stay fine, whatever the criteria want.
TEST(AdaptMeshMPI, KeepsToTheUsersLimits)
{
  auto overrides = adaptive;
  overrides.push_back("Adaptivity/Most cells=150");
  const auto few =
    small_scenes::read<2>(small_scenes::fluid_on_solid(), overrides);
  World<2> coarse(few, MPI_COMM_WORLD);
  coarse.adapt();
  EXPECT_LE(coarse.cells().size(), 150u);
  EXPECT_GE(coarse.cells().size(), 40u);

  overrides.back() = "Domain/Refinements/Names=corner";
  overrides.push_back("Domain/Refinements/corner/Shape=box(0, 0.65, 0.1, 0.8)");
  overrides.push_back("Domain/Refinements/corner/Levels=2");
  const auto boxed =
    small_scenes::read<2>(small_scenes::fluid_on_solid(), overrides);
  World<2> fine(boxed, MPI_COMM_WORLD);
  for (unsigned int step = 0; step < 3; ++step)
    {
      fine.move(step, false);
      fine.adapt();
      for (const auto &cell : fine.mesh->active_cell_iterators())
        if (cell->is_locally_owned() && cell->center()[0] < 0.1 &&
            cell->center()[1] > 0.7)
          {
            EXPECT_EQ(cell->level(), 2);
          }
    }
}


/// Four points of a cell that go to one and come back as four keep all that
/// the scheme says, and a rigid rotation keeps its spin.
TEST(RearrangeMPI, KeepsSpin)
{
  const auto scene =
    small_scenes::read<2>(small_scenes::free_block(),
                          {"Effects=inertia, adaptivity",
                           "Adaptivity/Surface=true",
                           "Bodies/block/Points per direction=4",
                           "Bodies/block/Initial velocity="
                           "-(y-0.5); x-0.5"});
  World<2> world(scene, MPI_COMM_WORLD);
  // The points of a lattice of 4 are small for their cells if it is one of 2.
  auto coarse                           = scene;
  coarse.bodies[0].points_per_direction = 2;
  ParticleSet<2> few(coarse, *world.mesh);
  few.accounting = world.particles.accounting;
  for (const auto &point : world.particles.handler())
    {
      const auto          mine = point.get_properties();
      std::vector<double> properties(mine.begin(), mine.end());
      few.handler().insert_particle(point.get_location(),
                                    point.get_reference_location(),
                                    point.get_id(),
                                    point.get_surrounding_cell(),
                                    properties);
    }
  few.handler().update_cached_numbers();
  const Audit before = audit(few);
  const auto  n      = few.handler().n_global_particles();
  const auto  report = rearrange(few, true, true);
  const Audit after  = audit(few);
  EXPECT_EQ(report.merged, n / 4 * 3);
  EXPECT_EQ(few.handler().n_global_particles(), n / 4);
  EXPECT_NEAR(after.angular_momentum[2],
              before.angular_momentum[2],
              1e-12 * before.angular_momentum[2]);
  // Of a lattice of spacing h/4 in a block of 4 h: the spin of the places,
  // a sixteenth of that of a cell of the lattice of spacing h/2, is taken up by
  // the cells' points, whose moments of inertia are four times the places'.
  EXPECT_NEAR(after.kinetic, before.kinetic, 0.02 * before.kinetic);
  EXPECT_NEAR(after.volume, before.volume, 1e-12);
  EXPECT_EQ(rearrange(few, true, true).merged, 0u);
}
