/**
 * @file
 * Should the tangent of a solid be a matrix, or be applied patch by patch from
 * the gradients at the points and a tangent for each? A full block of
 * neo-Hookean points, jittered and strained, in 2D and 3D; products with the
 * assembled matrix against those without one, in double precision and, as the
 * preconditioner takes them, in single. Both are checked against each other.
 * Times and bytes are by material point. Figures and decision:
 * doc/performance.md, "Matrix-free or not".
 */
#include <selkie/assembly/assembler.h>
#include <selkie/laws/hyperelastic_law.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>
#include <selkie/shape/lme_support.h>
#include <selkie/shape/occupancy.h>
#include <selkie/shape/simd.h>
#include <selkie/solver/float_block.h>
#include <selkie/terms/effect_table.h>
#include <selkie/transfer/transfer.h>

#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>

#include "../small_scenes.h"

using namespace selkie;
using dealii::AlignedVector;
using dealii::Tensor;

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

  /// Everything before the assembly, and a vector to multiply.
  template <int dim>
  struct Block
  {
    Block(const unsigned int n, const double gamma)
      : scene(small_scenes::read<dim>(scene_text<dim>(n, gamma)))
      , mesh(make_background_mesh<dim>(scene.domain, MPI_COMM_WORLD))
      , particles(scene, *mesh)
    {
      particles.seed();
      cloud      = std::make_unique<NodeCloud<dim>>(*mesh,
                                               scene.lme.gamma,
                                               scene.lme.support_tolerance);
      conditions = std::make_unique<NodeConditions<dim>>(scene, *cloud);
      system     = std::make_unique<System<dim>>(*cloud, *conditions, false);
      terms      = terms_of(scene);
      assembler  = std::make_unique<Assembler<dim>>(terms, *system);
      const auto occupancy = find_occupancy(particles, *cloud, false);
      fill_material_points(particles, *cloud, occupancy, table);
      for (unsigned int p = 0; p < table.points.size(); ++p)
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            table.points[p].F_n[i][j] += 0.1 * std::sin(p + 2. * i + 3. * j);
      system->reinit(occupancy, table);
      project(particles,
              table,
              *system,
              0.,
              dt,
              Vector(),
              static_cast<const NodalState<dim> *>(nullptr),
              fields);
      for (Vector *v : {&x, &y, &residual})
        system->initialize(*v);
      for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
        x.local_element(i) = std::sin(0.7 * i);
      assemble(true);
    }

    void
    assemble(const bool with_tangent)
    {
      assembler->assemble(table, time, fields, 1., with_tangent, residual);
    }

    unsigned int
    n_points() const
    {
      return table.points.size();
    }

    static constexpr double                          dt = 1e-3;
    Scene<dim>                                       scene;
    std::unique_ptr<typename ParticleSet<dim>::Mesh> mesh;
    ParticleSet<dim>                                 particles;
    std::unique_ptr<NodeCloud<dim>>                  cloud;
    std::unique_ptr<NodeConditions<dim>>             conditions;
    std::unique_ptr<System<dim>>                     system;
    std::vector<std::shared_ptr<const Term<dim>>>    terms;
    std::unique_ptr<Assembler<dim>>                  assembler;
    SupportTable<dim>                                table;
    StepFields                                       fields;
    Vector                                           x, y, residual;
    const StepTime time{0., Newmark(0.25, 0.5, dt)};
  };

  /// The tangents of as many points as V has lanes, whatever their law:
  /// PointForm::stiffness.
  template <int dim, typename V>
  struct AnyLaw
  {
    V C[dim][dim][dim][dim] = {};

    void
    set(const unsigned int lane, const PatchState<dim> &state, const unsigned q)
    {
      for (unsigned int j = 0; j < dim; ++j)
        for (unsigned int l = 0; l < dim; ++l)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int k = 0; k < dim; ++k)
              C[i][j][k][l][lane] = state.forms[q].stiffness[j][l][i][k];
    }

    /// From gradients of the vector (grad_n) to what its forces are made of.
    void
    apply(const V (&H)[dim][dim], V (&flux)[dim][dim]) const
    {
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < dim; ++j)
          {
            V sum{};
#pragma GCC unroll 4
            for (int k = 0; k < dim; ++k)
#pragma GCC unroll 4
              for (int l = 0; l < dim; ++l)
                sum += C[i][j][k][l] * H[k][l];
            flux[i][j] = sum;
          }
    }
  };

  /// The same of a neo-Hookean solid: f^{-1}, stress and two moduli (design,
  /// section 2) instead of dim^4 numbers. V_0 is in all of them.
  template <int dim, typename V>
  struct NeoHookeanOnly
  {
    V f_inv[dim][dim] = {}, tau[dim][dim] = {}, Gamma1 = {}, half8 = {};

    void
    set(const unsigned int lane, const PatchState<dim> &state, const unsigned q)
    {
      const auto        &point = state.point(q);
      const auto        &kin   = state.kinematics[q];
      const Tensor<2, 3> F     = kin.f * extend(point.F_n);
      const Tensor<2, 3> b     = left_cauchy_green(F);
      const auto response = static_cast<const HyperelasticLaw &>(*point.law)
                              .response(invariants(b, determinant(F)));
      const Tensor<2, 3> stress = kirchhoff_stress(response, b);
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          {
            f_inv[i][j][lane] = kin.f_inv[i][j];
            tau[i][j][lane]   = point.volume * stress[i][j];
          }
      Gamma1[lane] = point.volume * response.Gamma[0];
      half8[lane]  = point.volume * 0.5 * response.Gamma[7];
    }

    void
    apply(const V (&H)[dim][dim], V (&flux)[dim][dim]) const
    {
      V h[dim][dim], trace{};
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
        {
#pragma GCC unroll 4
          for (int j = 0; j < dim; ++j)
            {
              h[i][j] = V{};
#pragma GCC unroll 4
              for (int k = 0; k < dim; ++k)
                h[i][j] += H[i][k] * f_inv[k][j];
            }
          trace += h[i][i];
        }
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
        {
          V row[dim];
#pragma GCC unroll 4
          for (int j = 0; j < dim; ++j)
            {
              row[j] = half8 * (h[i][j] + h[j][i]);
#pragma GCC unroll 4
              for (int k = 0; k < dim; ++k)
                row[j] += h[i][k] * tau[k][j];
            }
          row[i] += Gamma1 * trace;
#pragma GCC unroll 4
          for (int j = 0; j < dim; ++j)
            {
              flux[i][j] = V{};
#pragma GCC unroll 4
              for (int k = 0; k < dim; ++k)
                flux[i][j] += row[k] * f_inv[j][k];
            }
        }
    }
  };

  /**
   * The action of the tangent, patch by patch: gradients of the vector at each
   * point (nodes in the lanes), fluxes (points in the lanes), forces (nodes in
   * the lanes again). One rank, no prescribed unknowns.
   */
  template <int dim, typename Number, template <int, typename> class Tangent>
  class PointOperator
  {
  public:
    explicit PointOperator(const Block<dim> &block)
    {
      PatchState<dim> state;
      state.table = &block.table;
      state.time  = &block.time;
      gradients.resize_fast(block.n_points() * dim * longest_list(block.table));
      std::size_t filled = 0;
      for (const auto &patch : block.table.patches)
        {
          add_nodes(block, patch, filled);
          for (unsigned int q = 0; q < patch.n_points; ++q)
            {
              const double *G = block.table.gradient(patch, q, 0);
              for (unsigned int k = 0; k < dim * patch.n_padded; ++k)
                gradients[filled++] = G[k];
            }
          add_tangents(block, patch, state);
        }
      gradients.resize_fast(filled);
      add_lumped_mass(block);
    }

    template <typename VectorType>
    void
    vmult(VectorType &y, const VectorType &x) const
    {
      for (unsigned int i = 0; i < diagonal.size(); ++i)
        y.local_element(i) = diagonal[i] * x.local_element(i);
      for (const Cell &cell : cells)
        {
          gather(cell, x.begin());
          set_fluxes(cell);
          add_forces(cell, y.begin());
        }
    }

    /// @param with_gradients those of the support table can be used instead
    std::size_t
    bytes(const bool with_gradients) const
    {
      return tangents.size() * sizeof(tangents[0]) +
             unknowns.size() * sizeof(unknowns[0]) +
             diagonal.size() * sizeof(Number) +
             (with_gradients ? gradients.size() * sizeof(Number) : 0);
    }

  private:
    using V                             = simd::NativeOf<Number>;
    static constexpr unsigned int lanes = sizeof(V) / sizeof(Number);

    struct Cell
    {
      unsigned int n_points, n_nodes, n_padded, first_unknown, first_tangent;
      std::size_t  first_gradient;
    };

    static unsigned int
    longest_list(const SupportTable<dim> &table)
    {
      unsigned int n = 0;
      for (const auto &patch : table.patches)
        n = std::max(n, patch.n_padded);
      return n;
    }

    void
    add_nodes(const Block<dim> &block,
              const Patch<dim> &patch,
              const std::size_t first_gradient)
    {
      cells.push_back({patch.n_points,
                       patch.n_nodes,
                       patch.n_padded,
                       unsigned(unknowns.size()),
                       unsigned(tangents.size()),
                       first_gradient});
      for (unsigned int a = 0; a < patch.n_nodes; ++a)
        unknowns.push_back(
          block.system->displacement(block.table.nodes[patch.first_node + a]));
      if (values.size() < dim * patch.n_padded)
        values.resize(dim * patch.n_padded);
      fluxes.resize(std::max<std::size_t>(fluxes.size(),
                                          (patch.n_points + lanes - 1) / lanes *
                                            lanes * dim * dim));
    }

    /// At increments of zero, as Block assembles.
    void
    add_tangents(const Block<dim> &block,
                 const Patch<dim> &patch,
                 PatchState<dim>  &state)
    {
      state.patch = &patch;
      state.h     = patch.cell->extent_in_direction(0);
      state.forms.assign(patch.n_points, PointForm<dim>());
      state.kinematics.resize(patch.n_points);
      for (auto &kin : state.kinematics)
        {
          kin.f = kin.f_inv = dealii::unit_symmetric_tensor<3>();
          for (unsigned int j = 0; j < dim; ++j)
            for (unsigned int i = 0; i < 3; ++i)
              kin.c[j][i] = kin.f_inv[j][i];
        }
      for (const auto &term : block.terms)
        if (term->acts_on(patch))
          term->add(state, true);
      for (unsigned int q = 0; q < patch.n_points; ++q)
        {
          if (q % lanes == 0)
            tangents.emplace_back();
          tangents.back().set(q % lanes, state, q);
        }
    }

    void
    add_lumped_mass(const Block<dim> &block)
    {
      Vector residual, sum, acceleration;
      for (Vector *v : {&residual, &sum, &acceleration})
        block.system->initialize(*v);
      const NodeState nodes{block.fields.mass, acceleration};
      for (const auto &term : block.terms)
        term->add_at_nodes(nodes, block.time.newmark, residual, &sum);
      diagonal.resize(sum.locally_owned_size());
      for (unsigned int i = 0; i < diagonal.size(); ++i)
        diagonal[i] = sum.local_element(i);
    }

    void
    gather(const Cell &cell, const Number *x) const
    {
      Number *to = values.data();
      for (unsigned int a = 0; a < cell.n_padded; ++a)
        {
          const bool    is_node = a < cell.n_nodes;
          const Number *from =
            is_node ? x + unknowns[cell.first_unknown + a] : x;
#pragma GCC unroll 4
          for (int d = 0; d < dim; ++d)
            to[d * cell.n_padded + a] = is_node ? from[d] : Number(0);
        }
    }

    void
    set_fluxes(const Cell &cell) const
    {
      const Number *G = gradients.data() + cell.first_gradient;
      for (unsigned int first = 0; first < cell.n_points; first += lanes)
        {
          V H[dim][dim] = {}, flux[dim][dim];
          for (unsigned int lane = 0;
               lane < lanes && first + lane < cell.n_points;
               ++lane, G += dim * cell.n_padded)
            add_gradient(cell, G, lane, H);
          tangents[cell.first_tangent + first / lanes].apply(H, flux);
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              for (unsigned int lane = 0; lane < lanes; ++lane)
                fluxes[(first + lane) * dim * dim + i * dim + j] =
                  flux[i][j][lane];
        }
    }

    /// The gradient at a point, in its lane.
    void
    add_gradient(const Cell        &cell,
                 const Number      *G,
                 const unsigned int lane,
                 V (&H)[dim][dim]) const
    {
      V sum[dim][dim] = {};
      for (unsigned int a = 0; a < cell.n_padded; a += lanes)
#pragma GCC unroll 4
        for (int i = 0; i < dim; ++i)
          {
            const V x = simd::load<V>(values.data() + i * cell.n_padded + a);
#pragma GCC unroll 4
            for (int j = 0; j < dim; ++j)
              sum[i][j] += x * simd::load<V>(G + j * cell.n_padded + a);
          }
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < dim; ++j)
          H[i][j][lane] = simd::sum(sum[i][j]);
    }

    void
    add_forces(const Cell &cell, Number *y) const
    {
      for (unsigned int a = 0; a < cell.n_padded; a += lanes)
        {
          const Number *G        = gradients.data() + cell.first_gradient + a;
          const Number *flux     = fluxes.data();
          V             sum[dim] = {};
          for (unsigned int q = 0; q < cell.n_points; ++q, flux += dim * dim)
#pragma GCC unroll 4
            for (int j = 0; j < dim; ++j, G += cell.n_padded)
              {
                const V g = simd::load<V>(G);
#pragma GCC unroll 4
                for (int i = 0; i < dim; ++i)
                  sum[i] += flux[i * dim + j] * g;
              }
          const unsigned int  n  = std::min(lanes, cell.n_nodes - a);
          const unsigned int *to = unknowns.data() + cell.first_unknown + a;
          for (unsigned int k = 0; k < n; ++k)
#pragma GCC unroll 4
            for (int d = 0; d < dim; ++d)
              y[to[k] + d] += sum[d][k];
        }
    }

    std::vector<Cell>            cells;
    std::vector<unsigned int>    unknowns; ///< first of each node of a list
    AlignedVector<Number>        gradients;
    std::vector<Tangent<dim, V>> tangents; ///< of some points each
    std::vector<Number>          diagonal; ///< of the lumped mass
    // scratch
    mutable AlignedVector<Number> values;
    mutable std::vector<Number>   fluxes;
  };

  // --- the benchmarks --------------------------------------------------------

  /// The last one asked for.
  template <int dim>
  std::unique_ptr<Block<dim>> kept;

  template <int dim>
  Block<dim> &
  block_of(const double gamma)
  {
    if (!kept<dim> || kept<dim>->scene.lme.gamma != gamma)
      {
        kept<dim>.reset();
        kept<dim> = std::make_unique<Block<dim>>(dim == 2 ? 128 : 16, gamma);
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

  template <int dim>
  void
  assemble(benchmark::State &state, const double gamma, const bool with_tangent)
  {
    auto &block = block_of<dim>(gamma);
    for (auto _ : state)
      block.assemble(with_tangent);
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

  template <int dim, typename Number, template <int, typename> class Tangent>
  void
  prepare_points(benchmark::State &state, const double gamma)
  {
    auto &block = block_of<dim>(gamma);
    for (auto _ : state)
      {
        const PointOperator<dim, Number, Tangent> points(block);
        benchmark::DoNotOptimize(&points);
      }
    report(state, block, 0.);
  }

  template <int dim, typename Number, template <int, typename> class Tangent>
  void
  multiply_points(benchmark::State &state, const double gamma)
  {
    constexpr bool is_double = std::is_same_v<Number, double>;
    auto          &block     = block_of<dim>(gamma);
    const PointOperator<dim, Number, Tangent>          points(block);
    dealii::LinearAlgebra::distributed::Vector<Number> x, y;
    x.reinit(block.system->partitioner());
    y.reinit(x);
    x.copy_locally_owned_data_from(block.x);
    for (auto _ : state)
      points.vmult(y, x);
    report(state, block, points.bytes(true));
    state.counters["own bytes/point"] =
      points.bytes(!is_double) / double(block.n_points());

    block.system->matrix().vmult(block.y, block.x);
    Vector difference(block.y);
    difference.copy_locally_owned_data_from(y);
    difference -= block.y;
    const double error      = difference.l2_norm() / block.y.l2_norm();
    state.counters["error"] = error;
    if (!(error < (is_double ? 1e-10 : 1e-5)))
      state.SkipWithError("the products differ");
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
    add("residual", [=](State &s) { assemble<dim>(s, gamma, false); });
    add("residual and matrix",
        [=](State &s) { assemble<dim>(s, gamma, true); });
    add("matrix to floats", [=](State &s) { copy_to_floats<dim>(s, gamma); });
    add("matrix product", [=](State &s) { multiply_matrix<dim>(s, gamma); });
    add("matrix product, float",
        [=](State &s) { multiply_floats<dim>(s, gamma); });
    add("points ready",
        [=](State &s) { prepare_points<dim, double, AnyLaw>(s, gamma); });
    add("points ready, float",
        [=](State &s) { prepare_points<dim, float, AnyLaw>(s, gamma); });
    add("points product",
        [=](State &s) { multiply_points<dim, double, AnyLaw>(s, gamma); });
    add("points product, float",
        [=](State &s) { multiply_points<dim, float, AnyLaw>(s, gamma); });
    add("points product, neo-Hookean", [=](State &s) {
      multiply_points<dim, double, NeoHookeanOnly>(s, gamma);
    });
    add("points product, neo-Hookean, float", [=](State &s) {
      multiply_points<dim, float, NeoHookeanOnly>(s, gamma);
    });
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
