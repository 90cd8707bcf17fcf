// The matrix of runs against a dense one: a chain of nodes over the ranks, each
// with two displacements and a pressure, of which three neighbours couple.
#include <selkie/assembly/row_products.h>
#include <selkie/assembly/system_matrix.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

namespace
{
  using namespace selkie;
  using Index = dealii::types::global_dof_index;

  constexpr unsigned int own_nodes = 6, reach = 3;

  unsigned int
  n_ranks()
  {
    return dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  }

  unsigned int
  rank()
  {
    return dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  }

  /// Of a node of the chain; component 2 is the pressure, behind the
  /// displacements of its rank.
  Index
  unknown(const unsigned int node, const unsigned int component)
  {
    const Index first = node / own_nodes * 3 * own_nodes, k = node % own_nodes;
    return component < 2 ? first + 2 * k + component
                         : first + 2 * own_nodes + k;
  }

  /// What the list of nodes that begins with `list` adds.
  double
  entry(const unsigned int list, const Index i, const Index j)
  {
    return std::sin(1. + list + 3. * i + 7. * j);
  }

  /// The nodes of a list.
  std::vector<unsigned int>
  nodes_of(const unsigned int list)
  {
    std::vector<unsigned int> nodes;
    for (unsigned int k = 0; k < reach && list + k < n_ranks() * own_nodes; ++k)
      nodes.push_back(list + k);
    return nodes;
  }

  std::vector<Index>
  unknowns_of(const unsigned int list)
  {
    std::vector<Index> all;
    for (const unsigned int node : nodes_of(list))
      for (unsigned int c = 0; c < 3; ++c)
        all.push_back(unknown(node, c));
    return all;
  }

  struct Chain
  {
    Chain()
    {
      const unsigned int n = 3 * own_nodes;
      dealii::IndexSet   own(n_ranks() * n), wide(n_ranks() * n);
      own.add_range(rank() * n, (rank() + 1) * n);
      for (const unsigned int list : lists())
        for (const Index i : unknowns_of(list))
          wide.add_index(i);
      rows =
        std::make_shared<dealii::Utilities::MPI::Partitioner>(own,
                                                              wide,
                                                              MPI_COMM_WORLD);

      std::map<unsigned int, RowGroup> groups; // by first row
      for (const unsigned int list : lists())
        for (const unsigned int node : nodes_of(list))
          for (const unsigned int c : {0u, 2u})
            {
              const auto row   = rows->global_to_local(unknown(node, c));
              auto      &group = groups[row];
              group.first_row  = row;
              group.n_rows     = c == 0 ? 2 : 1;
              for (const unsigned int other : nodes_of(list))
                {
                  const Index u = unknown(other, 0), p = unknown(other, 2);
                  group.columns.push_back({u, u + 2, false, 0});
                  group.columns.push_back({p, p + 1, true, 0});
                }
            }
      std::vector<RowGroup> all;
      for (auto &[row, group] : groups)
        all.push_back(group);
      matrix = std::make_unique<SystemMatrix>(rows, std::move(all));
    }

    /// Lists that this rank adds.
    std::vector<unsigned int>
    lists() const
    {
      std::vector<unsigned int> result(own_nodes);
      std::iota(result.begin(), result.end(), rank() * own_nodes);
      return result;
    }

    void
    fill()
    {
      matrix->clear();
      for (const unsigned int list : lists())
        for (const Index i : unknowns_of(list))
          for (const Index j : unknowns_of(list))
            matrix->add(rows->global_to_local(i),
                        rows->global_to_local(j),
                        entry(list, i, j));
      matrix->compress();
    }

    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> rows;
    std::unique_ptr<SystemMatrix>                              matrix;
  };

  /// The dense matrix, summed over the lists of all ranks.
  double
  exact(const Index i, const Index j)
  {
    double sum = 0.;
    for (unsigned int list = 0; list < n_ranks() * own_nodes; ++list)
      {
        const auto all = unknowns_of(list);
        if (std::count(all.begin(), all.end(), i) &&
            std::count(all.begin(), all.end(), j))
          sum += entry(list, i, j);
      }
    return sum;
  }
} // namespace


TEST(SystemMatrix, RunsAreJoinedWithinTheirKind)
{
  std::vector<ColumnRun> runs = {{4, 6, false, 0},
                                 {8, 9, true, 0},
                                 {0, 2, false, 0},
                                 {2, 4, false, 0},
                                 {6, 8, true, 0},
                                 {5, 6, false, 0}};
  join(runs);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].begin, 0u);
  EXPECT_EQ(runs[0].end, 6u);
  EXPECT_EQ(runs[1].begin, 6u);
  EXPECT_EQ(runs[1].end, 9u);
  EXPECT_TRUE(runs[1].pressures);
}


TEST(SystemMatrix, ProductsOfRunsOfAnyLength)
{
  std::vector<double> rows(80), x(40);
  for (unsigned int k = 0; k < 80; ++k)
    rows[k] = std::sin(k + 1.);
  for (unsigned int k = 0; k < 40; ++k)
    x[k] = std::sin(7. * k + 2.);
  for (unsigned int length = 0; length <= 40; ++length)
    {
      RowProducts<2, double> products;
      products.add(rows.data(), 40, x.data(), length);
      for (unsigned int r = 0; r < 2; ++r)
        {
          const auto row = rows.begin() + 40 * r;
          EXPECT_NEAR(products[r],
                      std::inner_product(row, row + length, x.begin(), 0.),
                      1e-13);
        }
      const std::vector<float> floats(rows.begin(), rows.end());
      const std::vector<float> x_floats(x.begin(), x.end());
      RowProducts<2, float>    single;
      single.add(floats.data(), 40, x_floats.data(), length);
      EXPECT_NEAR(single[1], products[1], 1e-5);
    }
}


TEST(SystemMatrixMPI, IsTheSumOfWhatAllRanksAdd)
{
  Chain chain;
  for (unsigned int repetition = 0; repetition < 2; ++repetition)
    {
      chain.fill();
      const auto &K = chain.matrix->epetra();
      int        *start, *column;
      double     *values;
      K.ExtractCrsDataPointers(start, column, values);
      for (int i = 0; i < K.NumMyRows(); ++i)
        for (int k = start[i]; k < start[i + 1]; ++k)
          EXPECT_NEAR(values[k], exact(K.GRID(i), K.GCID(column[k])), 1e-14);
      // Nothing is missing: the rows of a list have all of its columns.
      const Index first = chain.rows->local_range().first;
      for (unsigned int i = 0; i < 3 * own_nodes; ++i)
        {
          unsigned int n = 0;
          for (Index j = 0; j < chain.rows->size(); ++j)
            n += exact(first + i, j) != 0.;
          EXPECT_EQ(static_cast<unsigned int>(start[i + 1] - start[i]), n);
        }
    }
}


TEST(SystemMatrixMPI, MultipliesVectors)
{
  Chain chain;
  chain.fill();
  Vector x(chain.rows), y(chain.rows);
  for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
    x.local_element(i) = std::cos(chain.rows->local_to_global(i));
  chain.matrix->vmult(y, x);
  for (unsigned int i = 0; i < y.locally_owned_size(); ++i)
    {
      double sum = 0.;
      for (Index j = 0; j < chain.rows->size(); ++j)
        sum += exact(chain.rows->local_to_global(i), j) * std::cos(j);
      EXPECT_NEAR(y.local_element(i), sum, 1e-13);
    }
}
