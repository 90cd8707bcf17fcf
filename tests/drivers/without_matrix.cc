// Steps of 3D scenes whose tangent stays at the points, a solid and water with
// mixed and other solids: as by the matrix, and by the direct solver where
// conjugate gradients give up.
#include <selkie/drivers/stepper.h>
#include <selkie/mesh/background_mesh.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include "../small_scenes.h"

namespace
{
  using namespace selkie;

  /// A soft block that hangs from its left side, at acoustic CFL 15.
  std::string
  hanging_block()
  {
    return R"(
set Title     = hanging block
set Dimension = 3
set Effects   = inertia, gravity
subsection Domain
  set Lower corner = 0, 0, 0
  set Upper corner = 1.5, 1.5, 1
  set Cells        = 6, 6, 4
  subsection Walls
    set left   = fixed
    set right  = free
    set bottom = free
    set top    = free
    set front  = slip
    set back   = slip
  end
end
subsection Bodies
  set Names = block
  subsection block
    set Law    = neo hookean
    set Shape  = box(0, 0.5, 0, 1, 1, 1)
    set Jitter = 0.2
    subsection Law parameters
      set Density       = 1000
      set Young modulus = 1e6
      set Poisson ratio = 0.3
    end
  end
end
subsection Gravity
  set Acceleration = 0, -9.81, 0
end
subsection Time
  set End time = 0.3
  set Step     = 0.1
end
)";
  }

  struct Fall
  {
    explicit Fall(const std::vector<std::string> &overrides,
                  const std::string              &text = hanging_block())
      : scene(small_scenes::read<3>(text, overrides))
      , mesh(make_background_mesh(scene.domain, MPI_COMM_WORLD))
      , particles(scene, *mesh)
      , timers(MPI_COMM_WORLD)
    {
      particles.seed(); // deals the mesh out anew
      cloud   = std::make_unique<NodeCloud<3>>(*mesh,
                                             scene.lme.gamma,
                                             scene.lme.support_tolerance);
      stepper = std::make_unique<Stepper<3>>(
        scene, particles, *cloud, timers, [this](const std::string &line) {
          said += line + '\n';
        });
      stepper->start(0., scene.time.step);
      for (unsigned int n = 0; n < 2; ++n)
        {
          const auto report =
            stepper->step(n * scene.time.step, scene.time.step);
          n_iterations += report.newton.linear_iterations;
        }
      for (const auto &particle : particles.handler())
        for (unsigned int d = 0; d < 3; ++d)
          moments +=
            particle.get_location()[d] * (1. + d) * particle.get_location();
      for (unsigned int d = 0; d < 3; ++d)
        moments[d] = dealii::Utilities::MPI::sum(moments[d], MPI_COMM_WORLD);
    }

    Scene<3>                                                         scene;
    std::unique_ptr<dealii::parallel::distributed::Triangulation<3>> mesh;
    ParticleSet<3>                                                   particles;
    std::unique_ptr<NodeCloud<3>>                                    cloud;
    TimerTree                                                        timers;
    std::unique_ptr<Stepper<3>>                                      stepper;
    std::string                                                      said;
    unsigned int         n_iterations = 0;
    dealii::Tensor<1, 3> moments; ///< of the points' positions
  };

  const std::vector<std::string> exact = {
    "Newton/Tolerance=1e-11",
    "Linear solver/Tolerance=1e-11",
    "Linear solver/Loosest tolerance=1e-11"};

  std::vector<std::string>
  and_also(const std::string &setting)
  {
    auto settings = exact;
    settings.push_back(setting);
    return settings;
  }
} // namespace

TEST(WithoutMatrixMPI, StepsAreThoseOfTheMatrix)
{
  const Fall points(exact);
  const Fall matrix(and_also("Linear solver/Solver=direct"));
  EXPECT_EQ(points.said, "");
  EXPECT_GT(points.n_iterations, 0u);
  EXPECT_NE(points.stepper->system().points(), nullptr);
  EXPECT_EQ(points.stepper->system().n_nonzero_elements(), 0u);
  EXPECT_NE(points.stepper->solver_in_use(0.1).find("without a matrix"),
            std::string::npos)
    << points.stepper->solver_in_use(0.1);
  EXPECT_EQ(matrix.stepper->system().points(), nullptr);
  EXPECT_GT(matrix.stepper->system().n_nonzero_elements(), 0u);
  EXPECT_LT((points.moments - matrix.moments).norm(),
            1e-10 * matrix.moments.norm());
}

TEST(WithoutMatrixMPI, TheDirectSolverGetsAMatrix)
{
  const Fall points(and_also("Linear solver/Iterations=1"));
  const Fall matrix(and_also("Linear solver/Solver=direct"));
  EXPECT_NE(points.said.find("the direct solver takes over"), std::string::npos)
    << points.said;
  EXPECT_EQ(points.n_iterations, 0u);
  EXPECT_EQ(points.stepper->system().points(), nullptr);
  EXPECT_LT((points.moments - matrix.moments).norm(),
            1e-12 * matrix.moments.norm());
}

TEST(WithoutMatrixMPI, StepsOfWaterAndSolidsAreThoseOfTheMatrix)
{
  const std::string water = small_scenes::water_on_rubber(3);
  const Fall        points(and_also("Linear solver/Solver=gmres block"), water);
  const Fall        matrix(and_also("Linear solver/Solver=direct"), water);
  EXPECT_EQ(points.said, "");
  EXPECT_GT(points.n_iterations, 0u);
  EXPECT_NE(points.stepper->system().points(), nullptr);
  EXPECT_EQ(points.stepper->system().n_nonzero_elements(), 0u);
  EXPECT_GT(matrix.stepper->system().n_nonzero_elements(), 0u);
  EXPECT_LT((points.moments - matrix.moments).norm(),
            1e-10 * matrix.moments.norm());
}
