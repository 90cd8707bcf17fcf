// The tangent left at the points against the matrix: the same products and the
// same node blocks, with held unknowns, on any number of ranks.
#include <selkie/assembly/point_tangent.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../performance/assembled_scene.h"

namespace
{
  using namespace selkie;

  /// Two jittered blocks above each other that part (see Tangent.Contact):
  /// held at the left (wholly) and at the bottom (across).
  std::string
  two_blocks()
  {
    const auto body = [](const std::string &name,
                         const std::string &shape,
                         const std::string &velocity) {
      return "subsection " + name +
             "\nset Law = neo hookean\nset Shape = " + shape +
             "\nset Initial velocity = " + velocity + R"(
set Jitter = 0.2
subsection Law parameters
  set Density       = 1000
  set Young modulus = 1e6
  set Poisson ratio = 0.3
end
end
)";
    };
    return R"(
set Title     = two blocks
set Dimension = 3
set Effects   = inertia, contact
subsection Domain
  set Lower corner = 0, 0, 0
  set Upper corner = 1, 1.2, 0.8
  set Cells        = 5, 6, 4
  subsection Walls
    set left   = fixed
    set right  = free
    set bottom = slip
    set top    = free
    set front  = free
    set back   = free
  end
end
subsection Bodies
set Names = lower, upper
)" + body("lower", "box(0, 0, 0, 0.8, 0.5, 0.6)", "0; -20; 0") +
           body("upper", "box(0, 0.51, 0, 1, 0.9, 0.8)", "0; 0; 0") + R"(
end
subsection LME
  set Gamma = 2
end
subsection Time
  set End time = 0.02
  set Step     = 1e-3
end
)";
  }

  /// The blocks, strained, with their matrix.
  struct Problem : AssembledScene<3>
  {
    explicit Problem(const std::vector<std::string> &overrides)
      : AssembledScene<3>(two_blocks(), overrides)
    {
      for (auto &point : table.points)
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            point.F_n[i][j] +=
              0.1 * std::sin(40. * (point.x[i] + 2. * point.x[j]) + 3. * j);
      system->initialize(x);
      for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
        x.local_element(i) =
          std::sin(0.7 * x.get_partitioner()->local_to_global(i));
    }

    /// The largest difference relative to the largest entry, on all ranks.
    template <typename VectorType>
    static double
    difference(const VectorType &a, const Vector &b)
    {
      EXPECT_EQ(a.locally_owned_size(), b.locally_owned_size());
      double error = 0.;
      for (unsigned int i = 0; i < b.locally_owned_size(); ++i)
        error =
          std::max(error, std::abs(a.local_element(i) - b.local_element(i)));
      return dealii::Utilities::MPI::max(error, MPI_COMM_WORLD) /
             b.linfty_norm();
    }

    Vector x;
  };

  /// The entry of the matrix at two components of an owned node.
  double
  entry(const SystemMatrix &K,
        const unsigned int  row,
        const unsigned int  column)
  {
    int    *start, *columns;
    double *values;
    K.epetra().ExtractCrsDataPointers(start, columns, values);
    const int *at =
      std::find(columns + start[row], columns + start[row + 1], int(column));
    return values[at - columns];
  }
} // namespace

TEST(PointTangentMPI, MultipliesLikeTheMatrix)
{
  for (const std::string mass : {"lumped", "consistent"})
    {
      Problem problem({"Inertia/Mass=" + mass});
      auto   &system = *problem.system;
      Vector  by_matrix, by_points;
      system.initialize(by_matrix);
      system.initialize(by_points);
      problem.assemble(true);
      ASSERT_EQ(system.points(), nullptr);
      system.vmult(by_matrix, problem.x);
      const auto matrix = system.shared_matrix();

      system.want_points();
      problem.assemble(true);
      ASSERT_NE(system.points(), nullptr);
      EXPECT_EQ(system.shared_matrix(), nullptr);
      system.vmult(by_points, problem.x);
      EXPECT_LT(Problem::difference(by_points, by_matrix), 1e-13) << mass;

      const PointTangent<3, float>       floats(*system.points());
      PointTangent<3, float>::VectorType x, y;
      floats.initialize(x);
      floats.initialize(y);
      x.copy_locally_owned_data_from(problem.x);
      floats.vmult(y, x);
      EXPECT_LT(Problem::difference(y, by_matrix), 2e-6) << mass;

      const auto blocks = system.points()->node_blocks();
      const auto rough  = floats.node_blocks();
      double     error = 0., error_of_floats = 0., largest = 0.;
      ASSERT_EQ(3 * blocks.size(), system.n_owned());
      unsigned int n_held = 0;
      for (unsigned int i = 0; i < system.n_owned(); ++i)
        {
          n_held += system.held(i);
          for (unsigned int k = 0; k < 3; ++k)
            {
              const double exact = entry(*matrix, i, i / 3 * 3 + k);
              const auto   off   = [&](const auto &block) {
                return std::abs(block[i / 3][i % 3][k] - exact);
              };
              largest         = std::max(largest, std::abs(exact));
              error           = std::max(error, off(blocks));
              error_of_floats = std::max(error_of_floats, off(rough));
            }
        }
      EXPECT_LE(error, 1e-13 * largest) << mass;
      EXPECT_LE(error_of_floats, 2e-6 * largest) << mass;
      EXPECT_GT(dealii::Utilities::MPI::sum(n_held, MPI_COMM_WORLD), 0u);
    }
}

TEST(PointTangentMPI, TakesTheTangentsOfContactAndFoundation)
{
  // What they add to the matrix shows in the comparison only if it is there.
  const auto product = [](const std::vector<std::string> &overrides,
                          const bool                      points) {
    Problem problem(overrides);
    if (points)
      problem.system->want_points();
    problem.assemble(true);
    Vector y(problem.x);
    problem.system->vmult(y, problem.x);
    return y;
  };
  const auto with = [](const std::string &stiffness,
                       const std::string &penalty) {
    return std::vector<std::string>{
      "Effects=inertia, contact, spring foundation",
      "Spring foundation/Face=front",
      "Spring foundation/Stiffness=" + stiffness,
      "Contact/Penalty=" + penalty};
  };
  const Vector by_matrix = product(with("1e9", "1000"), false);
  const auto   off       = [&](const std::vector<std::string> &overrides) {
    return Problem::difference(product(overrides, true), by_matrix);
  };
  EXPECT_LT(off(with("1e9", "1000")), 1e-13);
  EXPECT_GT(off(with("1", "1000")), 1e-3);
  EXPECT_GT(off(with("1e9", "1")), 1e-3);
}
