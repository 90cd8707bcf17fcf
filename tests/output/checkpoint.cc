#include <selkie/base/exceptions.h>
#include <selkie/drivers/stepper.h>
#include <selkie/output/audit.h>
#include <selkie/output/checkpoint.h>

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "../small_scenes.h"
#include "../temporary_folder.h"
#include "block.h"

using namespace selkie;
using namespace selkie::test;

namespace
{
  template <int dim>
  void
  set_some_state(Matter<dim> &matter)
  {
    dealii::Tensor<1, dim> v;
    v[0]                     = 2.;
    dealii::Tensor<2, dim> F = dealii::unit_symmetric_tensor<dim>();
    F[0][1]                  = 0.3;
    matter.set_state(v, 1.5, F, 0.95);
  }

  template <int dim>
  void
  expect_same(const ParticleSet<dim> &a, const ParticleSet<dim> &b)
  {
    EXPECT_EQ(a.handler().n_global_particles(),
              b.handler().n_global_particles());
    const Audit of_a = audit(a), of_b = audit(b);
    EXPECT_NEAR(of_a.mass, of_b.mass, 1e-12 * of_a.mass);
    EXPECT_NEAR(of_a.energy(), of_b.energy(), 1e-12 * of_a.energy());
    EXPECT_NEAR(of_a.center.distance(of_b.center), 0., 1e-14);
    EXPECT_NEAR(of_a.angular_momentum[2],
                of_b.angular_momentum[2],
                1e-10 * of_a.mass);
  }

  /// Numbers with all their digits in use, and the sign of zero.
  template <int dim>
  double
  some_value(const dealii::Point<dim> &x)
  {
    return x[0] < 0.2 ? -0. : std::sin(1e3 * x[0]) / (0.1 + x[dim - 1]);
  }

  bool
  same_bits(const double a, const double b)
  {
    return std::memcmp(&a, &b, sizeof(double)) == 0;
  }

  /// Writes on all ranks and reads on all, and on each rank alone.
  template <int dim>
  void
  check_round_trip()
  {
    const TemporaryFolder folder(MPI_COMM_WORLD);
    Matter<dim>           matter(two_blocks<dim>());
    set_some_state(matter);
    const NodeCloud<dim> cloud(*matter.mesh);
    Vector               field(cloud.partitioner());
    for (unsigned int node = 0; node < cloud.n_owned(); ++node)
      field.local_element(node) = some_value(cloud.position(node));
    field.update_ghost_values();
    const std::string path = write_checkpoint(folder.path,
                                              matter.scene,
                                              matter.particles,
                                              *matter.mesh,
                                              cloud.dof_handler(),
                                              {{"some field", &field}},
                                              0.1,
                                              5,
                                              0.01);
    EXPECT_EQ(find_checkpoint(folder.path).folder, path);

    for (const MPI_Comm comm : {MPI_COMM_WORLD, MPI_COMM_SELF})
      {
        Matter<dim>        resumed(two_blocks<dim>(), comm, false);
        CarriedFields<dim> fields;
        const auto         state =
          read_checkpoint(path, resumed.particles, *resumed.mesh, fields);
        const NodeCloud<dim> nodes(*resumed.mesh);
        for (unsigned int node = 0; node < nodes.n_owned(); ++node)
          EXPECT_TRUE(
            same_bits(fields.values.at("some field")(nodes.global_index(node)),
                      some_value(nodes.position(node))));
        EXPECT_EQ(state.time, 0.1);
        EXPECT_EQ(state.step, 5u);
        EXPECT_EQ(state.dt, 0.01);
        EXPECT_EQ(state.accounting.seeded, matter.particles.accounting.seeded);
        expect_same(matter.particles, resumed.particles);
        resumed.particles.sort();
      }
  }
} // namespace

TEST(CheckpointMPI, RoundTrip2D)
{
  check_round_trip<2>();
}

TEST(CheckpointMPI, RoundTrip3D)
{
  check_round_trip<3>();
}

namespace
{
  /// The field on all ranks' nodes.
  std::map<std::pair<double, double>, double>
  values_by_place(const NodeCloud<2> &cloud, const Vector &field)
  {
    std::vector<std::array<double, 3>> mine;
    for (unsigned int node = 0; node < cloud.n_owned(); ++node)
      mine.push_back({{cloud.position(node)[0],
                       cloud.position(node)[1],
                       field.local_element(node)}});
    std::map<std::pair<double, double>, double> result;
    for (const auto &of_rank :
         dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, mine))
      for (const auto &[x, y, value] : of_rank)
        result[{x, y}] = value;
    return result;
  }

  /// Some steps of a scene; then all that its nodes keep comes back.
  void
  check_nodes_of_a_run(const std::string              &text,
                       const std::vector<std::string> &overrides,
                       const std::vector<std::string> &names)
  {
    const TemporaryFolder folder(MPI_COMM_WORLD);
    Matter<2>             run(small_scenes::read<2>(text, overrides));
    TimerTree             timers(MPI_COMM_WORLD);
    NodeCloud<2>          cloud(*run.mesh);
    Stepper<2>            stepper(
      run.scene, run.particles, cloud, timers, [](const std::string &) {});
    stepper.start(0., run.scene.time.step);
    for (unsigned int n = 0; n < 2; ++n)
      stepper.step(n * run.scene.time.step, run.scene.time.step);
    const auto        kept = stepper.kept_fields();
    const std::string path = write_checkpoint(folder.path,
                                              run.scene,
                                              run.particles,
                                              *run.mesh,
                                              cloud.dof_handler(),
                                              kept,
                                              0.,
                                              2,
                                              1.);

    Matter<2>        resumed(run.scene, MPI_COMM_WORLD, false);
    CarriedFields<2> fields;
    read_checkpoint(path, resumed.particles, *resumed.mesh, fields);
    EXPECT_EQ(fields.values.size(), names.size());
    // The nodes may have other numbers and owners: they are known by places.
    const NodeCloud<2> nodes(*resumed.mesh);
    for (const std::string &name : names)
      {
        const auto written = values_by_place(cloud, *kept.at(name));
        double     largest = 0.;
        for (const auto &place_and_value : written)
          largest = std::max(largest, std::abs(place_and_value.second));
        EXPECT_GT(largest, 0.) << name;
        for (unsigned int node = 0; node < nodes.n_owned(); ++node)
          {
            const auto  &x = nodes.position(node);
            const double a = written.at({x[0], x[1]});
            const double b = fields.values.at(name)(nodes.global_index(node));
            EXPECT_TRUE(same_bits(a, b)) << name << ": " << a << ", " << b;
          }
      }
  }

  const std::vector<std::string> nodal_state = {"displacement x",
                                                "displacement y",
                                                "velocity x",
                                                "velocity y",
                                                "acceleration x",
                                                "acceleration y"};
} // namespace

namespace
{
  template <int dim>
  std::vector<dealii::CellId>
  own_cells(const dealii::Triangulation<dim> &mesh)
  {
    std::vector<dealii::CellId> cells;
    for (const auto &cell : mesh.active_cell_iterators())
      if (cell->is_locally_owned())
        cells.push_back(cell->id());
    return cells;
  }

  /// Ids in the order in which the handler iterates.
  template <int dim>
  std::vector<dealii::types::particle_index>
  ids(const ParticleSet<dim> &particles)
  {
    std::vector<dealii::types::particle_index> result;
    for (const auto &point : particles.handler())
      result.push_back(point.get_id());
    return result;
  }

  /// On as many ranks each gets the cells and points back that it had.
  template <int dim>
  void
  check_partition(const CellWeight<dim> &weight)
  {
    const TemporaryFolder folder(MPI_COMM_WORLD);
    Matter<dim>           matter(two_blocks<dim>());
    matter.particles.rebalance(weight);
    const NodeCloud<dim> cloud(*matter.mesh);
    const std::string    path = write_checkpoint(folder.path,
                                              matter.scene,
                                              matter.particles,
                                              *matter.mesh,
                                              cloud.dof_handler(),
                                              {},
                                              0.1,
                                              5,
                                              0.01);
    Matter<dim>          resumed(two_blocks<dim>());
    CarriedFields<dim>   fields;
    read_checkpoint(path, resumed.particles, *resumed.mesh, fields);
    EXPECT_EQ(own_cells(*matter.mesh), own_cells(*resumed.mesh));
    EXPECT_EQ(ids(matter.particles), ids(resumed.particles));
  }
} // namespace

TEST(CheckpointMPI, EachRankGetsItsCellsBack)
{
  check_partition<2>([](const auto &) { return 1; });
  check_partition<2>(
    [](const auto &cell) { return cell->center()[0] < 0.3 ? 50 : 1; });
  check_partition<3>(
    [](const auto &cell) { return cell->center()[1] < 0.2 ? 1 : 3; });
  // a cell that weighs as much as all others: ranks without any
  for (const dealii::Point<2> &heavy :
       {dealii::Point<2>(0.05, 0.05), dealii::Point<2>(0.7, 0.3)})
    check_partition<2>([&heavy](const auto &cell) {
      return cell->point_inside(heavy) ? 10000 : 1;
    });
}

TEST(CheckpointMPI, NodesOfALagrangianMesh)
{
  check_nodes_of_a_run(small_scenes::free_block(),
                       {"Approximation=q4 fem",
                        "Bodies/block/Initial velocity=8*(x-0.5); 6*x*y"},
                       nodal_state);
}

TEST(CheckpointMPI, PressureOfTheNodes)
{
  auto names = nodal_state;
  names.push_back("pressure");
  check_nodes_of_a_run(small_scenes::fluid_on_solid(),
                       {"Approximation=q4 fem", "Bodies/water/Jitter=0"},
                       names);
}

TEST(CheckpointMPI, KeepsTheLastTwoAndTheRunGoesOn)
{
  const TemporaryFolder folder(MPI_COMM_WORLD);
  Matter<2>             matter(two_blocks<2>());
  set_some_state(matter);
  const NodeCloud<2>   cloud(*matter.mesh);
  const auto           n = matter.particles.handler().n_global_particles();
  dealii::Tensor<1, 2> shift;
  shift[0] = 0.05;
  for (const unsigned int step : {10, 20, 30})
    {
      write_checkpoint(folder.path,
                       matter.scene,
                       matter.particles,
                       *matter.mesh,
                       cloud.dof_handler(),
                       {},
                       0.1 * step,
                       step,
                       0.1);
      matter.particles.move(std::vector<dealii::Tensor<1, 2>>(
        matter.particles.handler().n_locally_owned_particles(), shift));
      EXPECT_EQ(matter.particles.handler().n_global_particles(), n);
    }
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string checkpoints = folder.path + "/checkpoint/";
  EXPECT_FALSE(std::filesystem::exists(checkpoints + "000010"));
  EXPECT_TRUE(std::filesystem::exists(checkpoints + "000020"));
  EXPECT_EQ(find_checkpoint(folder.path).folder, checkpoints + "000030");
}

TEST(CheckpointMPI, OrderBeyondAMillionSteps)
{
  const TemporaryFolder folder(MPI_COMM_WORLD);
  Matter<2>             matter(two_blocks<2>());
  const NodeCloud<2>    cloud(*matter.mesh);
  for (const unsigned int step : {999990, 1000000, 1000010})
    write_checkpoint(folder.path,
                     matter.scene,
                     matter.particles,
                     *matter.mesh,
                     cloud.dof_handler(),
                     {},
                     1e-3 * step,
                     step,
                     1e-3);
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string checkpoints = folder.path + "/checkpoint/";
  EXPECT_FALSE(std::filesystem::exists(checkpoints + "999990"));
  EXPECT_EQ(find_checkpoint(folder.path).folder, checkpoints + "1000010");

  // From 999990, as a run that was killed leaves them: a later checkpoint
  // without its mark, an earlier one, and a folder of somebody else.
  MPI_Barrier(MPI_COMM_WORLD);
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    {
      std::filesystem::rename(checkpoints + "1000000", checkpoints + "999990");
      std::filesystem::create_directory(checkpoints + "1 kept by hand");
      std::ofstream(checkpoints + "last_good") << "999990";
    }
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_EQ(find_checkpoint(folder.path).folder, checkpoints + "999990");
}

TEST(CheckpointMPI, RefusesAnotherScene)
{
  const TemporaryFolder folder(MPI_COMM_WORLD);
  EXPECT_THROW(find_checkpoint(folder.path).folder, SceneError);

  Matter<2>          matter(two_blocks<2>());
  const NodeCloud<2> cloud(*matter.mesh);
  const std::string  path  = write_checkpoint(folder.path,
                                            matter.scene,
                                            matter.particles,
                                            *matter.mesh,
                                            cloud.dof_handler(),
                                            {},
                                            0.,
                                            0,
                                            0.1);
  Scene<2>           other = two_blocks<2>();
  other.inertia.reset();
  Matter<2>        resumed(other, MPI_COMM_WORLD, false);
  CarriedFields<2> fields;
  EXPECT_THROW(read_checkpoint(path, resumed.particles, *resumed.mesh, fields),
               SceneError);
}
