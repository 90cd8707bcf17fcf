#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/node_cloud.h>

#include <deal.II/lac/la_parallel_vector.h>

#include <boost/serialization/map.hpp>
#include <boost/serialization/utility.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "../test_shapes.h"

namespace
{
  using namespace selkie;
  using dealii::Point;

  constexpr double gamma_hat = 1.8, tolerance = 1e-6;

  /// All nodes of the mesh and their h, collected cell by cell on every rank.
  template <int dim>
  std::map<std::array<long long, dim>, std::pair<Point<dim>, double>>
  all_nodes(const dealii::parallel::distributed::Triangulation<dim> &mesh)
  {
    std::vector<std::vector<double>> mine;
    for (const auto &cell : mesh.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int v : cell->vertex_indices())
          {
            mine.push_back({cell->minimum_vertex_distance()});
            for (unsigned int d = 0; d < dim; ++d)
              mine.back().push_back(cell->vertex(v)[d]);
          }
    std::map<std::array<long long, dim>, std::pair<Point<dim>, double>> nodes;
    for (const auto &list :
         dealii::Utilities::MPI::all_gather(mesh.get_communicator(), mine))
      for (const auto &entry : list)
        {
          std::array<long long, dim> key;
          Point<dim>                 x;
          for (unsigned int d = 0; d < dim; ++d)
            {
              x[d]             = entry[1 + d];
              key[dim - 1 - d] = std::llround(x[d] * 1e6); // x fastest
            }
          const auto found     = nodes.insert({key, {x, entry[0]}}).first;
          found->second.second = std::min(found->second.second, entry[0]);
        }
    return nodes;
  }

  template <int dim, typename Cell>
  double
  distance(const Point<dim> &x, const Cell &cell)
  {
    double square = 0;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double outside = std::max({cell->vertex(0)[d] - x[d],
                                         x[d] - cell->vertex((1 << dim) - 1)[d],
                                         0.});
        square += outside * outside;
      }
    return std::sqrt(square);
  }

  /// Every owned cell's list against all nodes, in order.
  template <int dim>
  void
  compare_with_brute_force(const Domain<dim> &domain)
  {
    const auto           mesh = make_background_mesh(domain, MPI_COMM_WORLD);
    const NodeCloud<dim> cloud(*mesh, gamma_hat, tolerance);
    const auto           nodes = all_nodes(*mesh);
    EXPECT_EQ(cloud.n_global(), nodes.size());
    EXPECT_EQ(dealii::Utilities::MPI::sum(cloud.n_owned(), MPI_COMM_WORLD),
              nodes.size());

    const double           reach = std::sqrt(-std::log(tolerance) / gamma_hat);
    unsigned long          wrong = 0;
    std::set<unsigned int> used;
    for (const auto &cell : mesh->active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const auto &list = cloud.nodes_near(cell);
          auto        node = list.begin();
          for (const auto &[key, value] : nodes)
            if (distance(value.first, cell) <= reach * value.second)
              {
                if (node == list.end() ||
                    cloud.position(*node).distance(value.first) > 1e-12 ||
                    std::abs(cloud.spacing(*node) - value.second) > 1e-12)
                  ++wrong;
                else
                  ++node;
              }
          wrong += list.end() - node; // extra ones
          used.insert(list.begin(), list.end());
          const auto corners = cloud.corners(cell);
          for (const unsigned int v : cell->vertex_indices())
            if (cloud.position(corners[v]).distance(cell->vertex(v)) > 1e-12)
              ++wrong;
          EXPECT_EQ(&list, &cloud.nodes_near(cell)); // kept
        }
    EXPECT_EQ(wrong, 0u);
    for (unsigned int i = cloud.n_owned(); i < cloud.size(); ++i)
      EXPECT_TRUE(used.count(i)) << "useless halo node";
  }

  /// Ghost entries of a nodal vector arrive at the right nodes.
  template <int dim>
  void
  exchange_positions(const Domain<dim> &domain)
  {
    const auto           mesh = make_background_mesh(domain, MPI_COMM_WORLD);
    const NodeCloud<dim> cloud(*mesh, gamma_hat, tolerance);
    dealii::LinearAlgebra::distributed::Vector<double> field(
      cloud.partitioner());
    const auto value = [&cloud](const unsigned int node) {
      const auto &x = cloud.position(node);
      return x[0] + 10. * x[1] + 100. * x[dim - 1] + cloud.spacing(node);
    };
    for (unsigned int i = 0; i < cloud.n_owned(); ++i)
      field.local_element(i) = value(i);
    field.update_ghost_values();
    for (unsigned int i = 0; i < cloud.size(); ++i)
      {
        EXPECT_EQ(field.local_element(i), value(i));
        EXPECT_EQ(field(cloud.global_index(i)), value(i));
      }
  }
} // namespace


TEST(NodeCloudMPI, ListsAreThoseOfBruteForce2D)
{
  compare_with_brute_force<2>(test::graded_domain<2>());
}

TEST(NodeCloudMPI, ListsAreThoseOfBruteForce3D)
{
  compare_with_brute_force<3>(test::graded_domain<3>());
}

TEST(NodeCloudMPI, MoreRanksThanTrees)
{
  Domain<2> domain = test::graded_domain<2>();
  domain.cells     = {{2, 1}};
  domain.refinements.clear();
  compare_with_brute_force<2>(domain);
}

TEST(NodeCloudMPI, GhostValuesArriveAtTheirNodes)
{
  exchange_positions<2>(test::graded_domain<2>());
  exchange_positions<3>(test::graded_domain<3>());
}

TEST(NodeCloudMPI, Layers)
{
  const auto mesh =
    make_background_mesh(test::graded_domain<2>(), MPI_COMM_WORLD);
  const unsigned int n_layers = 3;
  const NodeCloud<2> one(*mesh, gamma_hat, tolerance);
  const NodeCloud<2> cloud(*mesh, gamma_hat, tolerance, n_layers);
  EXPECT_EQ(cloud.n_global(), n_layers * one.n_global());
  ASSERT_EQ(cloud.size(), n_layers * one.size());
  EXPECT_EQ(cloud.n_owned(), n_layers * one.n_owned());
  for (unsigned int i = 0; i < cloud.size(); ++i)
    {
      EXPECT_EQ(cloud.in_layer(i, cloud.layer(i)), i);
      const unsigned int first = cloud.in_layer(i, 0);
      EXPECT_EQ(first / n_layers, i / n_layers);
      EXPECT_EQ(cloud.global_index(i) - cloud.global_index(first),
                cloud.layer(i));
      EXPECT_EQ(cloud.position(i), one.position(i / n_layers));
      EXPECT_EQ(cloud.spacing(i), one.spacing(i / n_layers));
      EXPECT_EQ(cloud.volume(i), one.volume(i / n_layers));
      EXPECT_EQ(cloud.n_cells_around(i), one.n_cells_around(i / n_layers));
    }
  for (const auto &cell : mesh->active_cell_iterators())
    if (cell->is_locally_owned())
      {
        EXPECT_EQ(cloud.nodes_near(cell).size(),
                  n_layers * one.nodes_near(cell).size());
        for (unsigned int layer = 0; layer < n_layers; ++layer)
          for (const unsigned int v : cell->vertex_indices())
            EXPECT_EQ(cloud.corners(cell, layer)[v],
                      n_layers * one.corners(cell)[v] + layer);
      }
}

TEST(NodeCloudMPI, SpacingsAndBeta)
{
  Domain<2> domain = test::graded_domain<2>();
  domain.refinements.clear();
  const auto         mesh = make_background_mesh(domain, MPI_COMM_WORLD);
  const NodeCloud<2> cloud(*mesh, gamma_hat, tolerance);
  const double       h = 1. / 10.;
  EXPECT_NEAR(cloud.smallest_spacing(), h, 1e-15);
  for (unsigned int i = 0; i < cloud.size(); ++i)
    {
      EXPECT_NEAR(cloud.spacing(i), h, 1e-15);
      EXPECT_NEAR(cloud.beta(i) * h * h, gamma_hat, 1e-12);
    }
}
