#include <selkie/solver/node_blocks.h>

#include <Epetra_CrsMatrix.h>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  std::vector<bool>
  pressure_unknowns(const System<dim> &system)
  {
    const auto       &partition = *system.partitioner();
    std::vector<bool> result(partition.locally_owned_size() +
                             partition.n_ghost_indices());
    for (unsigned int node = 0; node < system.cloud.size(); ++node)
      if (system.pressure(node) != invalid_index)
        result[system.pressure(node)] = true;
    return result;
  }


  template <int n_rows, int n_columns>
  template <int dim>
  NodeBlocks<n_rows, n_columns>::NodeBlocks(
    const System<dim>                    &system,
    const TrilinosWrappers::SparseMatrix &K,
    const std::vector<bool>              &is_pressure,
    const Part                            rows,
    const Part                            columns)
  {
    int    *row_start, *matrix_column;
    double *entries;
    K.trilinos_matrix().ExtractCrsDataPointers(row_start,
                                               matrix_column,
                                               entries);
    std::vector<unsigned int> unknown_of(K.trilinos_matrix().NumMyCols(),
                                         invalid_index);
    const auto               &column_of = system.matrix_columns();
    for (unsigned int i = 0; i < column_of.size(); ++i)
      if (column_of[i] >= 0)
        unknown_of[column_of[i]] = i;

    const unsigned int n_u = system.n_owned_displacements();
    first_row              = rows == Part::displacements ? 0 : n_u;
    const unsigned int end =
      rows == Part::displacements ? n_u : system.n_owned();
    const bool pressures = columns == Part::pressures;
    start.reserve((end - first_row) / n_rows + 1);
    start.push_back(0);
    for (unsigned int row = first_row; row < end; row += n_rows)
      {
        // The rows of a node have the same columns, and the columns of a node
        // follow each other.
        for (int k = row_start[row]; k < row_start[row + 1]; ++k)
          {
            const unsigned int i = unknown_of[matrix_column[k]];
            if (is_pressure[i] != pressures)
              continue;
            column.push_back(i);
            const int place = k - row_start[row];
            for (int r = 0; r < n_rows; ++r)
              for (int c = 0; c < n_columns; ++c)
                values.push_back(entries[row_start[row + r] + place + c]);
            k += n_columns - 1;
          }
        start.push_back(column.size());
      }
  }


  template <int n_rows, int n_columns>
  void
  NodeBlocks<n_rows, n_columns>::vmult(FloatVector       &y,
                                       const FloatVector &x) const
  {
    x.update_ghost_values();
    y = 0.f;
    vmult_add(y, 1.f, x);
    x.zero_out_ghost_values();
  }


  template <int n_rows, int n_columns>
  void
  NodeBlocks<n_rows, n_columns>::vmult_add(FloatVector       &y,
                                           const float        factor,
                                           const FloatVector &x) const
  {
    const float *from  = x.begin();
    const float *value = values.data();
    float       *to    = y.begin() + first_row;
    for (unsigned int a = 0; a + 1 < start.size(); ++a, to += n_rows)
      {
        float sum[n_rows] = {};
        for (unsigned int k = start[a]; k < start[a + 1];
             ++k, value += n_rows * n_columns)
          {
            const float *x_b = from + column[k];
            for (int i = 0; i < n_rows; ++i)
              for (int j = 0; j < n_columns; ++j)
                sum[i] += value[i * n_columns + j] * x_b[j];
          }
        for (int i = 0; i < n_rows; ++i)
          to[i] += factor * sum[i];
      }
  }

  template std::vector<bool>
  pressure_unknowns(const System<2> &);
  template std::vector<bool>
  pressure_unknowns(const System<3> &);

  template class NodeBlocks<2, 2>;
  template class NodeBlocks<3, 3>;
  template class NodeBlocks<2, 1>;
  template class NodeBlocks<3, 1>;
  template class NodeBlocks<1, 2>;
  template class NodeBlocks<1, 3>;
  template class NodeBlocks<1, 1>;

#define INSTANTIATE(dim, n_rows, n_columns)                                \
  template NodeBlocks<n_rows, n_columns>::NodeBlocks(                      \
    const System<dim> &,                                                   \
    const TrilinosWrappers::SparseMatrix &,                                \
    const std::vector<bool> &,                                             \
    const Part,                                                            \
    const Part)
  INSTANTIATE(2, 2, 2);
  INSTANTIATE(2, 2, 1);
  INSTANTIATE(2, 1, 2);
  INSTANTIATE(2, 1, 1);
  INSTANTIATE(3, 3, 3);
  INSTANTIATE(3, 3, 1);
  INSTANTIATE(3, 1, 3);
  INSTANTIATE(3, 1, 1);
#undef INSTANTIATE
} // namespace selkie
