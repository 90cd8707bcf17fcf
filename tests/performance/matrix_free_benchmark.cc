/**
 * @file
 * Should the tangent of a solid be a matrix, or stay at the points? A full
 * block of neo-Hookean points, jittered and strained, in 2D and 3D; the
 * program's SystemMatrix and FloatBlock against its PointTangent, in double
 * precision and, as the preconditioner takes them, in single. Times and bytes
 * are by material point. Figures and decision: doc/performance.md, "Matrix-free
 * or not".
 */
#include <selkie/solver/float_block.h>

#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>

#include "assembled_scene.h"

using namespace selkie;

namespace
{
  /// A solid that fills its domain, n cells a direction.
  template <int dim>
  std::string
  scene_text(const unsigned int n, const double gamma)
  {
    const auto repeat = [](const std::string &word) {
      return dim == 2 ? word + ", " + word : word + ", " + word + ", " + word;
    };
    std::string walls;
    for (const char *wall : {"left", "right", "bottom", "top", "front", "back"})
      if (dim == 3 || (wall[0] != 'f' && std::string(wall) != "back"))
        walls += "set " + std::string(wall) + " = free\n";
    return "set Title     = solid block\n"
           "set Dimension = " +
           std::to_string(dim) +
           "\nset Effects   = inertia\n"
           "subsection Domain\nset Lower corner = " +
           repeat("0") + "\nset Upper corner = " + repeat("1") +
           "\nset Cells = " + repeat(std::to_string(n)) +
           "\nsubsection Walls\n" + walls +
           "end\nend\n"
           "subsection Bodies\nset Names = block\nsubsection block\n"
           "set Law = neo hookean\nset Jitter = 0.2\nset Shape = box(" +
           repeat("0") + ", " + repeat("1") +
           ")\nsubsection Law parameters\nset Density = 1000\n"
           "set Young modulus = 1e6\nset Poisson ratio = 0.3\nend\nend\nend\n"
           "subsection LME\nset Gamma = " +
           std::to_string(gamma) +
           "\nend\n"
           "subsection Time\nset End time = 0.02\nset Step = 1e-3\nend\n";
  }

  /// The block, strained, with its matrix and a vector to multiply.
  template <int dim>
  struct Block : AssembledScene<dim>
  {
    Block(const unsigned int n, const double gamma)
      : AssembledScene<dim>(scene_text<dim>(n, gamma))
    {
      auto &points = this->table.points;
      for (unsigned int p = 0; p < points.size(); ++p)
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            points[p].F_n[i][j] += 0.1 * std::sin(p + 2. * i + 3. * j);
      for (Vector *v : {&x, &y})
        this->system->initialize(*v);
      for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
        x.local_element(i) = std::sin(0.7 * i);
      this->assemble(true);
    }

    unsigned int
    n_points() const
    {
      return this->table.points.size();
    }

    Vector x, y;
  };

  /// The last one asked for.
  template <int dim>
  std::unique_ptr<Block<dim>> kept;

  /// @param points whether its tangent is there, and not a matrix
  template <int dim>
  Block<dim> &
  block_of(const double gamma, const bool points = false)
  {
    if (!kept<dim> || kept<dim>->scene.lme.gamma != gamma)
      {
        kept<dim>.reset();
        kept<dim> = std::make_unique<Block<dim>>(dim == 2 ? 128 : 16, gamma);
      }
    auto &system = *kept<dim>->system;
    if (points != (system.points() != nullptr))
      {
        if (points)
          system.want_points();
        else
          system.want_matrix(kept<dim>->table);
        kept<dim>->assemble(true);
      }
    return *kept<dim>;
  }

  template <int dim>
  void
  report(benchmark::State &state, const Block<dim> &block, const double bytes)
  {
    using benchmark::Counter;
    const double n = block.n_points();
    state.counters["point"] =
      Counter(n * state.iterations(), Counter::kIsRate | Counter::kInvert);
    if (bytes > 0.)
      state.counters["bytes/point"] = bytes / n;
  }

  /// What is assembled besides the residual.
  enum class What
  {
    residual,
    matrix,
    points
  };

  template <int dim>
  void
  assemble(benchmark::State &state, const double gamma, const What what)
  {
    auto &block = block_of<dim>(gamma, what == What::points);
    for (auto _ : state)
      block.assemble(what != What::residual);
    report(state, block, 0.);
    const auto &table = block.table;
    state.counters["nodes/list"] =
      double(table.nodes.size()) / table.patches.size();
  }

  template <int dim>
  void
  multiply_matrix(benchmark::State &state, const double gamma)
  {
    auto       &block  = block_of<dim>(gamma);
    const auto &matrix = block.system->matrix();
    for (auto _ : state)
      matrix.vmult(block.y, block.x);
    // Epetra has a column index for each value.
    report(state, block, 12. * matrix.n_nonzero_elements());
    state.counters["entries/row"] =
      double(matrix.n_nonzero_elements()) / block.x.size();
  }

  template <int dim>
  void
  copy_to_floats(benchmark::State &state, const double gamma)
  {
    auto &block = block_of<dim>(gamma);
    for (auto _ : state)
      {
        const FloatBlock copy(*block.system,
                              Part::displacements,
                              Part::displacements);
        benchmark::DoNotOptimize(&copy);
      }
    report(state, block, 0.);
  }

  template <int dim>
  void
  multiply_floats(benchmark::State &state, const double gamma)
  {
    auto            &block = block_of<dim>(gamma);
    const FloatBlock matrix(*block.system,
                            Part::displacements,
                            Part::displacements);
    FloatVector      x = float_vector(block.system->matrix()), y = x;
    x.copy_locally_owned_data_from(block.x);
    for (auto _ : state)
      matrix.vmult(y, x);
    report(state, block, 4. * block.system->matrix().n_nonzero_elements());
  }

  template <int dim>
  void
  multiply_points(benchmark::State &state, const double gamma)
  {
    auto       &block  = block_of<dim>(gamma, true);
    const auto &points = *block.system->points();
    for (auto _ : state)
      points.vmult(block.y, block.x);
    report(state, block, points.memory_consumption());
  }

  template <int dim>
  void
  copy_points_to_floats(benchmark::State &state, const double gamma)
  {
    auto &block = block_of<dim>(gamma, true);
    for (auto _ : state)
      {
        const PointTangent<dim, float> copy(*block.system->points());
        benchmark::DoNotOptimize(&copy);
      }
    report(state, block, 0.);
  }

  template <int dim>
  void
  multiply_float_points(benchmark::State &state, const double gamma)
  {
    auto                          &block = block_of<dim>(gamma, true);
    const PointTangent<dim, float> points(*block.system->points());
    FloatVector                    x, y;
    points.initialize(x);
    points.initialize(y);
    x.copy_locally_owned_data_from(block.x);
    for (auto _ : state)
      points.vmult(y, x);
    report(state, block, points.memory_consumption());
  }

  template <int dim>
  void
  find_node_blocks(benchmark::State &state, const double gamma)
  {
    auto                          &block = block_of<dim>(gamma, true);
    const PointTangent<dim, float> points(*block.system->points());
    for (auto _ : state)
      benchmark::DoNotOptimize(points.node_blocks());
    report(state, block, 0.);
  }

  template <int dim>
  void
  add(const double gamma)
  {
    const std::string prefix =
      std::to_string(dim) + "d/gamma " + (gamma == 3. ? "3" : "1.8") + "/";
    const auto add = [&](const std::string &name, const auto &run) {
      benchmark::RegisterBenchmark((prefix + name).c_str(), run)
        ->Unit(benchmark::kMillisecond);
    };
    using State = benchmark::State;
    add("residual", [=](State &s) { assemble<dim>(s, gamma, What::residual); });
    add("residual and matrix",
        [=](State &s) { assemble<dim>(s, gamma, What::matrix); });
    add("matrix to floats", [=](State &s) { copy_to_floats<dim>(s, gamma); });
    add("matrix product", [=](State &s) { multiply_matrix<dim>(s, gamma); });
    add("matrix product, float",
        [=](State &s) { multiply_floats<dim>(s, gamma); });
    add("residual and points",
        [=](State &s) { assemble<dim>(s, gamma, What::points); });
    add("points to floats",
        [=](State &s) { copy_points_to_floats<dim>(s, gamma); });
    add("points product", [=](State &s) { multiply_points<dim>(s, gamma); });
    add("points product, float",
        [=](State &s) { multiply_float_points<dim>(s, gamma); });
    add("points, node blocks, float",
        [=](State &s) { find_node_blocks<dim>(s, gamma); });
  }
} // namespace

int
main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  for (const double gamma : {3., 1.8})
    {
      add<2>(gamma);
      add<3>(gamma);
    }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  kept<2>.reset(); // before MPI ends
  kept<3>.reset();
}
