#include <selkie/base/exceptions.h>
#include <selkie/output/audit.h>
#include <selkie/output/checkpoint.h>

#include <gtest/gtest.h>

#include <filesystem>

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

  /// Writes on all ranks and reads on all, and on each rank alone.
  template <int dim>
  void
  check_round_trip()
  {
    const TemporaryFolder folder(MPI_COMM_WORLD);
    Matter<dim>           matter(two_blocks<dim>());
    set_some_state(matter);
    const std::string path = write_checkpoint(
      folder.path, matter.scene, matter.particles, *matter.mesh, 0.1, 5, 0.01);
    EXPECT_EQ(last_good_checkpoint(folder.path), path);

    for (const MPI_Comm comm : {MPI_COMM_WORLD, MPI_COMM_SELF})
      {
        Matter<dim> resumed(two_blocks<dim>(), comm, false);
        const auto  state =
          read_checkpoint(path, resumed.particles, *resumed.mesh);
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

TEST(CheckpointMPI, KeepsTheLastTwoAndTheRunGoesOn)
{
  const TemporaryFolder folder(MPI_COMM_WORLD);
  Matter<2>             matter(two_blocks<2>());
  set_some_state(matter);
  const auto           n = matter.particles.handler().n_global_particles();
  dealii::Tensor<1, 2> shift;
  shift[0] = 0.05;
  for (const unsigned int step : {10, 20, 30})
    {
      write_checkpoint(folder.path,
                       matter.scene,
                       matter.particles,
                       *matter.mesh,
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
  EXPECT_EQ(last_good_checkpoint(folder.path), checkpoints + "000030");
}

TEST(CheckpointMPI, RefusesAnotherScene)
{
  const TemporaryFolder folder(MPI_COMM_WORLD);
  EXPECT_THROW(last_good_checkpoint(folder.path), SceneError);

  Matter<2>         matter(two_blocks<2>());
  const std::string path = write_checkpoint(
    folder.path, matter.scene, matter.particles, *matter.mesh, 0., 0, 0.1);
  Scene<2> other = two_blocks<2>();
  other.inertia.reset();
  Matter<2> resumed(other, MPI_COMM_WORLD, false);
  EXPECT_THROW(read_checkpoint(path, resumed.particles, *resumed.mesh),
               SceneError);
}
