// The tangent left at the points against the matrix: the same products and the
// same node blocks, with held unknowns, on any number of ranks.
#include <selkie/solver/tangent_blocks.h>

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

  /// A vector with something in each entry, the same on any ranks.
  template <int dim>
  Vector
  some_vector(const System<dim> &system)
  {
    Vector x;
    system.initialize(x);
    for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
      x.local_element(i) =
        std::sin(0.7 * x.get_partitioner()->local_to_global(i));
    return x;
  }

  /// The largest difference relative to the largest entry, on all ranks, of the
  /// owned entries [begin, end).
  template <typename VectorType, typename Other>
  double
  difference(const VectorType  &a,
             const Other       &b,
             const unsigned int begin,
             const unsigned int end)
  {
    double error = 0., largest = 0.;
    for (unsigned int i = begin; i < end; ++i)
      {
        error =
          std::max<double>(error,
                           std::abs(a.local_element(i) - b.local_element(i)));
        largest = std::max<double>(largest, std::abs(b.local_element(i)));
      }
    return dealii::Utilities::MPI::max(error, MPI_COMM_WORLD) /
           dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
  }

  template <typename VectorType>
  double
  difference(const VectorType &a, const Vector &b)
  {
    EXPECT_EQ(a.locally_owned_size(), b.locally_owned_size());
    return difference(a, b, 0, b.locally_owned_size());
  }

  /// The blocks, strained.
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
      x = some_vector(*system);
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
      EXPECT_LT(difference(by_points, by_matrix), 1e-13) << mass;

      const PointTangent<3, float>       floats(*system.points());
      PointTangent<3, float>::VectorType x, y;
      floats.initialize(x);
      floats.initialize(y);
      x.copy_locally_owned_data_from(problem.x);
      floats.vmult(y, x);
      EXPECT_LT(difference(y, by_matrix), 2e-6) << mass;

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
    return difference(product(overrides, true), by_matrix);
  };
  EXPECT_LT(off(with("1e9", "1000")), 1e-13);
  EXPECT_GT(off(with("1", "1000")), 1e-3);
  EXPECT_GT(off(with("1e9", "1")), 1e-3);
}

namespace
{
  /// Water, rubber with a pressure and a solid without: a matrix and the
  /// tangent at the points, with pressures in some unit.
  template <int dim>
  struct Mixed : AssembledScene<dim>
  {
    explicit Mixed(const std::vector<std::string> &overrides)
      : AssembledScene<dim>(small_scenes::water_on_rubber(dim), overrides)
    {
      System<dim> &system = *this->system;
      x                   = some_vector(system);
      system.initialize(by_matrix);
      this->assemble(true, unit);
      matrix = system.shared_matrix();
      matrix->vmult(by_matrix, x);
      matrix_blocks = std::make_unique<MatrixBlocks<dim>>(system);
      of_matrix     = matrix_blocks->D_inverse();
      schur         = matrix_blocks->schur_diagonal(of_matrix);
      system.want_points();
      this->assemble(true, unit);
      point_blocks = std::make_unique<PointBlocks<dim>>(system);
    }

    static constexpr double unit = 300.;

    Vector                              x, by_matrix;
    std::shared_ptr<const SystemMatrix> matrix;
    std::unique_ptr<MatrixBlocks<dim>>  matrix_blocks;
    std::unique_ptr<PointBlocks<dim>>   point_blocks;
    FloatVector of_matrix, schur; ///< D^{-1}, diagonal of S
  };

  template <int dim>
  void
  compare_mixed(const std::string &mass)
  {
    SCOPED_TRACE(std::to_string(dim) + "D, mass " + mass);
    const Mixed<dim>   mixed({"Inertia/Mass=" + mass});
    const System<dim> &system = *mixed.system;
    const unsigned int n_u    = system.n_owned_displacements(),
                       n      = system.n_owned();
    ASSERT_NE(system.points(), nullptr);
    ASSERT_GT(system.n_global_pressures(), 0u);
    Vector y;
    system.initialize(y);
    system.vmult(y, mixed.x);
    EXPECT_LT(difference(y, mixed.by_matrix, 0, n_u), 1e-13);
    EXPECT_LT(difference(y, mixed.by_matrix, n_u, n), 1e-13);

    // The blocks: of a vector in the matrix's columns, of one in the system's
    // layout, and exactly.
    Vector of_u(mixed.x), of_p(mixed.x), exact;
    system.initialize(exact);
    for (unsigned int i = 0; i < n; ++i)
      (i < n_u ? of_p : of_u).local_element(i) = 0.;
    FloatVector in_columns(mixed.of_matrix), from_columns(mixed.of_matrix);
    in_columns = 0.f;
    in_columns.copy_locally_owned_data_from(mixed.x);
    const PointBlocks<dim> &points = *mixed.point_blocks;
    FloatVector             x(points.D_inverse()), from_points;
    x = 0.f;
    from_points.reinit(x);
    x.copy_locally_owned_data_from(mixed.x);

    mixed.matrix->vmult(exact, of_p);
    points.vmult_B(from_points, x);
    mixed.matrix_blocks->vmult_B(from_columns, in_columns);
    EXPECT_LT(difference(from_points, exact, 0, n_u), 2e-6);
    EXPECT_LT(difference(from_columns, exact, 0, n_u), 2e-6);

    points.vmult_pressures(from_points, x);
    mixed.matrix_blocks->vmult_pressures(from_columns, in_columns);
    EXPECT_LT(difference(from_points, mixed.by_matrix, n_u, n), 2e-6);
    EXPECT_LT(difference(from_columns, mixed.by_matrix, n_u, n), 2e-6);

    const auto A = points.displacements();
    A->vmult(from_points, x);
    mixed.matrix->vmult(exact, of_u);
    EXPECT_LT(difference(from_points, exact, 0, n_u), 2e-6);
    const FloatVector D_inverse = points.D_inverse();
    EXPECT_LT(difference(D_inverse, mixed.of_matrix, 0, n_u), 2e-6);

    // The diagonal of S is an estimate: 0.9 to 2.7 of it here.
    const FloatVector schur  = points.schur_diagonal(D_inverse);
    double            lowest = 1e300, highest = 0.;
    for (unsigned int i = n_u; i < n; ++i)
      {
        const double ratio =
          schur.local_element(i) / mixed.schur.local_element(i);
        lowest  = std::min(lowest, ratio);
        highest = std::max(highest, ratio);
      }
    lowest  = dealii::Utilities::MPI::min(lowest, MPI_COMM_WORLD);
    highest = dealii::Utilities::MPI::max(highest, MPI_COMM_WORLD);
    EXPECT_GT(lowest, 0.8);
    EXPECT_LT(highest, 3.);
  }
} // namespace

TEST(PointTangentMPI, MultipliesLikeTheMatrixWithPressures)
{
  for (const std::string mass : {"lumped", "consistent"})
    {
      compare_mixed<2>(mass);
      compare_mixed<3>(mass);
    }
}
