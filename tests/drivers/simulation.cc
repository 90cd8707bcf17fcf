// Whole runs that fail where no step can be tried again.
#include <selkie/base/exceptions.h>
#include <selkie/drivers/simulation.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/output/checkpoint.h>
#include <selkie/output/files.h>

#include <gtest/gtest.h>

#include "../small_scenes.h"
#include "../temporary_folder.h"

namespace
{
  using namespace selkie;

  /// Stands the nodes of the first mesh only.
  class FirstMeshOnly : public Effect<2>
  {
  public:
    void
    hold(const Scene<2> & /*scene*/,
         const NodeCloud<2> &cloud,
         const double /*t*/,
         NodeConditions<2> & /*conditions*/) const override
    {
      const auto n = cloud.dof_handler().n_dofs();
      if (n_nodes == 0)
        n_nodes = n;
      if (n == n_nodes)
        return;
      throw NumericalFailure("another mesh");
    }

    mutable dealii::types::global_dof_index n_nodes = 0;
  };

  /// A block that flies, in a mesh that is fine at its surface.
  Scene<2>
  flying_block(const std::string &folder)
  {
    auto scene = small_scenes::read<2>(small_scenes::free_block(),
                                       {"Effects=inertia, adaptivity",
                                        "Adaptivity/Surface=true",
                                        "Adaptivity/Steps=2",
                                        "Adaptivity/Finer levels=1",
                                        "Bodies/block/Initial velocity=10; 0",
                                        "Output/Directory=" + folder + "/run",
                                        "Time/End time=0.006",
                                        "Output/Checkpoint steps=1"});
    scene.file = folder + "/scene.prm"; // which a run copies
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      write_text(scene.file, small_scenes::free_block());
    return scene;
  }

  /// Its files are complete, for all ranks, when this returns.
  int
  run_quietly(const Scene<2> &scene, const bool resumed)
  {
    testing::internal::CaptureStdout();
    const int code = run_scene(scene, MPI_COMM_WORLD, resumed);
    testing::internal::GetCapturedStdout();
    MPI_Barrier(MPI_COMM_WORLD);
    return code;
  }
} // namespace

/// Neither the stepper of the old mesh nor one of the new is of use then: the
/// run ends with its reason, and goes on from its last checkpoint when the
/// reason is gone.
TEST(SimulationMPI, AFailureWhileAdaptingKeepsTheLastCheckpoint)
{
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const std::string     directory = folder.path + "/run";
  auto                  scene     = flying_block(folder.path);
  const auto            demanding = std::make_shared<FirstMeshOnly>();
  scene.effects.push_back({"first mesh only", demanding});

  EXPECT_EQ(run_quietly(scene, false), 2);
  const std::string summary = read_text(directory + "/summary.json");
  EXPECT_NE(summary.find("another mesh"), std::string::npos);
  EXPECT_NE(read_text(directory + "/log.txt").find("adapting the mesh"),
            std::string::npos);
  // The mesh is adapted after two steps, of which the first kept one.
  EXPECT_EQ(find_checkpoint(directory).folder,
            directory + "/checkpoint/000001");

  EXPECT_EQ(run_quietly(flying_block(folder.path), true), 0);
  EXPECT_EQ(read_text(directory + "/summary.json").find("another mesh"),
            std::string::npos);
}
