// LME evaluations per second: random points in the interior cell [0,1]^dim of a
// grid of spacing 1, lambda from 0 (or warm), to 1e-12 h, N and grad N. Boxes
// are evaluated by lme_evaluate_points(), some points a call.
#include <selkie/shape/lme.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <string>

using namespace selkie;
using dealii::AlignedVector;
using dealii::Point;
using dealii::Tensor;

namespace
{
  enum Lists
  {
    own_list,  // each point has the nodes within R of it
    union_list // all points share the nodes within R of the cell
  };

  constexpr unsigned int n_points = 256;

  /// Grid nodes (integer coordinates) for which keep(node) holds.
  template <int dim, class Keep>
  LmeNodes<dim>
  grid_nodes(const double gamma, const Keep &keep)
  {
    std::vector<Point<dim>> points;
    const int               reach = 6, z_reach = (dim == 3 ? reach : 0);
    for (int k = -z_reach; k <= z_reach; ++k)
      for (int j = -reach; j <= reach; ++j)
        for (int i = -reach; i <= reach; ++i)
          {
            Point<dim> p;
            p[0] = i;
            p[1] = j;
            if (dim == 3)
              p[dim - 1] = k;
            if (keep(p))
              points.push_back(p);
          }
    LmeNodes<dim> nodes;
    nodes.reinit(points, std::vector<double>(points.size(), gamma), 1.);
    return nodes;
  }

  template <int dim>
  double
  distance_to_cell(const Point<dim> &p)
  {
    Tensor<1, dim> away;
    for (unsigned int d = 0; d < dim; ++d)
      away[d] = std::max({-p[d], p[d] - 1., 0.});
    return away.norm();
  }

  template <int dim>
  std::vector<LmeNodes<dim>>
  make_lists(const Lists                    kind,
             const double                   gamma,
             const std::vector<Point<dim>> &points)
  {
    const double R = lme_support_radius(1., gamma, 1e-6);
    if (kind == union_list)
      return {grid_nodes<dim>(gamma, [&](const Point<dim> &p) {
        return distance_to_cell(p) < R;
      })};
    std::vector<LmeNodes<dim>> lists;
    for (const Point<dim> &x : points)
      lists.push_back(grid_nodes<dim>(gamma, [&](const Point<dim> &p) {
        return p.distance(x) < R;
      }));
    return lists;
  }

  /// The box of nodes around the cell that contains those within R of it.
  template <int dim>
  LmeNodes<dim>
  make_box(const double gamma)
  {
    const int                     reach = lme_support_radius(1., gamma, 1e-6);
    std::array<unsigned int, dim> size;
    Point<dim>                    origin;
    for (unsigned int d = 0; d < dim; ++d)
      {
        size[d]   = 2 * reach + 2;
        origin[d] = -reach;
      }
    return LmeNodes<dim>::make_box(origin, 1., size, gamma);
  }

  template <int dim>
  std::vector<Point<dim>>
  random_points()
  {
    std::mt19937                     random(1);
    std::uniform_real_distribution<> uniform(0., 1.);
    std::vector<Point<dim>>          points(n_points);
    for (auto &x : points)
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = uniform(random);
    return points;
  }

  /// lambda of a point 0.02 h away.
  template <int dim>
  Tensor<1, dim>
  warm_start(const LmeNodes<dim> &nodes, Point<dim> x)
  {
    AlignedVector<double> N(nodes.n_padded);
    Tensor<1, dim>        lambda;
    x[0] += 0.02;
    lme_evaluate(nodes, x, lambda, N.data(), nullptr);
    return lambda;
  }

  void
  report(benchmark::State &state,
         const double      n_nodes,
         const std::size_t n_steps)
  {
    const double n_evaluations = double(state.iterations()) * n_points;
    state.SetItemsProcessed(n_evaluations);
    state.counters["nodes"]  = n_nodes;
    state.counters["Newton"] = n_steps / n_evaluations;
  }

  template <int dim>
  void
  evaluate_box(benchmark::State &state, const bool warm)
  {
    const double       gamma = state.range(0) / 10.;
    const unsigned int batch = state.range(1);
    const auto         nodes = make_box<dim>(gamma);

    // The points of a call.
    std::vector<std::vector<Point<dim>>>     points;
    std::vector<std::vector<Tensor<1, dim>>> start;
    for (const Point<dim> &x : random_points<dim>())
      {
        if (points.empty() || points.back().size() == batch)
          {
            points.emplace_back();
            start.emplace_back();
          }
        points.back().push_back(x);
        start.back().push_back(warm ? warm_start(nodes, x) : Tensor<1, dim>());
      }

    AlignedVector<double>       values(batch * (dim + 1) * nodes.n_padded);
    std::vector<Tensor<1, dim>> lambda;
    std::size_t                 n_steps = 0;
    for (auto _ : state)
      for (unsigned int i = 0; i < points.size(); ++i)
        {
          lambda = start[i];
          n_steps +=
            lme_evaluate_points(nodes, points[i], lambda, values.data());
          benchmark::DoNotOptimize(values.data());
          benchmark::ClobberMemory();
        }
    report(state, nodes.n, n_steps);
  }

  template <int dim>
  void
  evaluate(benchmark::State &state, const Lists kind, const bool warm)
  {
    const double gamma  = state.range(0) / 10.;
    const auto   points = random_points<dim>();
    const auto   lists  = make_lists<dim>(kind, gamma, points);

    std::size_t n_max = 0, n_sum = 0, n_steps = 0;
    for (const auto &list : lists)
      {
        n_max = std::max<std::size_t>(n_max, list.n_padded);
        n_sum += list.n;
      }
    AlignedVector<double>       N(n_max), grad(dim * n_max);
    std::vector<Tensor<1, dim>> start(n_points);
    if (warm)
      for (unsigned int p = 0; p < n_points; ++p)
        start[p] = warm_start(lists[p % lists.size()], points[p]);
    for (auto _ : state)
      for (unsigned int p = 0; p < n_points; ++p)
        {
          Tensor<1, dim> lambda = start[p];
          n_steps += lme_evaluate(
            lists[p % lists.size()], points[p], lambda, N.data(), grad.data());
          benchmark::DoNotOptimize(N.data());
          benchmark::ClobberMemory();
        }
    report(state, double(n_sum) / lists.size(), n_steps);
  }

  // The first argument is 10 gamma.
  template <int dim>
  void
  add(const char *list, const Lists kind)
  {
    const std::string name = std::to_string(dim) + "d/" + list;
    benchmark::RegisterBenchmark((name + "/cold").c_str(),
                                 evaluate<dim>,
                                 kind,
                                 false)
      ->Arg(8)
      ->Arg(18)
      ->Arg(30);
    benchmark::RegisterBenchmark((name + "/warm").c_str(),
                                 evaluate<dim>,
                                 kind,
                                 true)
      ->Arg(18);
  }

  // The second argument is the number of points a call.
  template <int dim>
  void
  add_box()
  {
    const std::string name = std::to_string(dim) + "d/box";
    benchmark::RegisterBenchmark((name + "/cold").c_str(),
                                 evaluate_box<dim>,
                                 false)
      ->ArgsProduct({{8, 18, 30}, {8}})
      ->ArgsProduct({{18}, {1, 4, 64}});
    benchmark::RegisterBenchmark((name + "/warm").c_str(),
                                 evaluate_box<dim>,
                                 true)
      ->Args({18, 8});
  }
} // namespace

int
main(int argc, char **argv)
{
  add<2>("own_list", own_list);
  add<2>("union_list", union_list);
  add_box<2>();
  add<3>("own_list", own_list);
  add<3>("union_list", union_list);
  add_box<3>();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
