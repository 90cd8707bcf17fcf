#include <selkie/base/exceptions.h>
#include <selkie/output/probes.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "../temporary_folder.h"
#include "block.h"

using namespace selkie;
using namespace selkie::test;

namespace
{
  /// The last row of a CSV file by column.
  std::map<std::string, double>
  last_row(const std::string &path)
  {
    std::ifstream file(path);
    std::string   header, line, last;
    std::getline(file, header);
    while (std::getline(file, line))
      last = line;
    std::istringstream            names(header), values(last);
    std::map<std::string, double> row;
    std::string                   name, value;
    while (std::getline(names, name, ',') && std::getline(values, value, ','))
      row[name] = std::stod(value);
    return row;
  }

  Scene<2>
  scene_with_probes()
  {
    using Kind     = Probe<2>::Kind;
    Scene<2> scene = two_blocks<2>();
    scene.probes.resize(10);
    scene.probes[0].name     = "nearest";
    scene.probes[0].position = dealii::Point<2>(0.25, 0.5);
    scene.probes[1].name     = "around";
    scene.probes[1].position = dealii::Point<2>(0.375, 0.5);
    scene.probes[1].radius   = 0.1;
    scene.probes[2].name     = "region";
    scene.probes[2].kind     = Kind::region;
    scene.probes[2].shape    = scene.bodies[1].shape;
    scene.probes[3].name     = "wall";
    scene.probes[3].kind     = Kind::wall_force;
    scene.probes[3].wall     = 2;
    scene.probes[4].name     = "front";
    scene.probes[4].kind     = Kind::front;
    scene.probes[4].body     = 1;
    scene.probes[5].name     = "extent";
    scene.probes[5].kind     = Kind::extent;
    scene.probes[5].body     = 0;
    scene.probes[6].name     = "displacement error";
    scene.probes[6].kind     = Kind::error;
    scene.probes[6].function =
      std::make_shared<VectorExpression<2>>("X; 0.06*t - 0.1");
    scene.probes[7].name     = "velocity error";
    scene.probes[7].kind     = Kind::error;
    scene.probes[7].body     = 1;
    scene.probes[7].quantity = Probe<2>::Quantity::velocity;
    scene.probes[7].function = std::make_shared<VectorExpression<2>>("2; 3");
    scene.probes[8].name     = "height";
    scene.probes[8].kind     = Kind::height;
    scene.probes[8].body     = 1;
    scene.probes[8].axis     = 1;
    scene.probes[8].position = dealii::Point<2>(0.7, 0.);
    scene.probes[8].radius   = 0.05;
    scene.probes[9].name     = "force";
    scene.probes[9].kind     = Kind::body_force;
    scene.probes[9].body     = 1;
    scene.probes[9].position = dealii::Point<2>(0.5, 0.3);
    return scene;
  }
} // namespace

TEST(ProbesMPI, AllKindsFollowATranslation)
{
  const TemporaryFolder folder(MPI_COMM_WORLD);
  std::filesystem::create_directories(folder.path + "/probes");
  MPI_Barrier(MPI_COMM_WORLD);

  Matter<2>            matter(scene_with_probes());
  dealii::Tensor<1, 2> v, shift;
  v[0]     = 2.;
  shift[0] = 0.11;
  shift[1] = -0.07;
  matter.set_state(v, 0., dealii::unit_symmetric_tensor<2>(), 0.9);
  Probes<2> probes(matter.scene, matter.particles, folder.path);

  WallForces<2> walls;
  probes.record(0., walls);
  matter.particles.move(std::vector<dealii::Tensor<1, 2>>(
    matter.particles.handler().n_locally_owned_particles(), shift));
  walls.force.resize(4);
  walls.moment.resize(4);
  walls.force[2][1]  = -5.;
  walls.moment[2][2] = 2.;
  probes.record(0.5, walls);
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
    return;

  const auto row = [&](const std::string &name) {
    return last_row(folder.path + "/probes/" + name + ".csv");
  };
  for (const char *name : {"nearest", "around", "region"})
    {
      EXPECT_EQ(row(name)["time (s)"], 0.5);
      EXPECT_NEAR(row(name)["displacement x (m)"], 0.11, 1e-14);
      EXPECT_NEAR(row(name)["displacement y (m)"], -0.07, 1e-14);
      EXPECT_NEAR(row(name)["velocity x (m/s)"], 2., 1e-14);
    }
  // Two points are equally near: their mean is half a spacing inside.
  EXPECT_NEAR(row("nearest")["position x (m)"], 0.25 + 1. / 32 + 0.11, 1e-14);
  EXPECT_NEAR(row("nearest")["position y (m)"], 0.5 - 0.07, 1e-14);
  EXPECT_NEAR(row("around")["position x (m)"], 0.375 + 0.11, 1e-14);
  EXPECT_NEAR(row("region")["position x (m)"], 0.625 + 0.11, 1e-13);
  EXPECT_EQ(row("wall")["force y (N/m)"], -5.);
  EXPECT_EQ(row("wall")["moment z (N)"], 2.);
  EXPECT_NEAR(row("height")["height y (m)"], 0.75 - 1. / 32 - 0.07, 1e-14);
  // At rest its surroundings carry its weight.
  const double weight = fluid_rho * 0.125 * gravity;
  EXPECT_NEAR(row("force")["force y (N/m)"], weight, 1e-9);
  EXPECT_NEAR(row("force")["moment z (N)"],
              (0.625 + 0.11 - 0.5) * weight,
              1e-9);
  EXPECT_NEAR(row("front")["front x (m)"], 0.75 - 1. / 32 + 0.11, 1e-14);
  EXPECT_NEAR(row("front")["rear x (m)"], 0.5 + 1. / 32 + 0.11, 1e-14);

  auto extent = row("extent");
  EXPECT_NEAR(extent["volume (m^2)"], 0.125, 1e-14);
  EXPECT_NEAR(extent["center x (m)"], 0.375 + 0.11, 1e-13);
  EXPECT_NEAR(extent["min y (m)"], 0.25 + 1. / 32 - 0.07, 1e-14);
  EXPECT_NEAR(extent["max y (m)"], 0.75 - 1. / 32 - 0.07, 1e-14);
  EXPECT_NEAR(extent["semi-axis x (m)"], 2 * std::sqrt(15. / 12) / 16, 1e-12);

  // X has the mean 3/8 and the variance 5/4 / 16^2 over the body's four columns
  // of points; the second component is right.
  auto error = row("displacement error");
  EXPECT_NEAR(error["L2 error (m)"],
              std::sqrt(5. / 4 / 256 + std::pow(0.375 - 0.11, 2)),
              1e-14);
  EXPECT_NEAR(error["largest error (m)"], 0.5 - 1. / 32 - 0.11, 1e-14);
  EXPECT_NEAR(error["L2 norm of the function (m)"],
              std::sqrt(5. / 4 / 256 + std::pow(0.375, 2) + std::pow(0.07, 2)),
              1e-14);
  error = row("velocity error");
  EXPECT_NEAR(error["L2 error (m/s)"], 3., 1e-14);
  EXPECT_NEAR(error["largest error (m/s)"], 3., 1e-14);
  EXPECT_NEAR(error["L2 norm of the function (m/s)"], std::sqrt(13.), 1e-14);
}
