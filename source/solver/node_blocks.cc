#include <selkie/solver/node_blocks.h>

#include <Epetra_CrsMatrix.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  ColumnLayout::ColumnLayout(const System<dim> &system)
    : n_u(system.n_owned_displacements())
    , n(system.n_owned())
  {
    const auto      &own     = system.partitioner()->locally_owned_range();
    const auto      &columns = system.matrix().trilinos_matrix().ColMap();
    std::vector<int> numbers(columns.NumMyElements());
    columns.MyGlobalElements(numbers.data());
    IndexSet                             wide(own.size());
    std::vector<types::global_dof_index> sorted(numbers.begin(), numbers.end());
    std::sort(sorted.begin(), sorted.end());
    wide.add_indices(sorted.begin(), sorted.end());
    wide.subtract_set(own);
    partition = std::make_shared<dealii::Utilities::MPI::Partitioner>(
      own, wide, system.partitioner()->get_mpi_communicator());
    for (const int number : numbers)
      entry_of.push_back(partition->global_to_local(number));

    FloatVector kind = vector(); // told by the owners
    for (unsigned int i = 0; i < n; ++i)
      kind.local_element(i) = i < n_u ? i % dim : -1.;
    kind.update_ghost_values();
    component.resize(n + partition->n_ghost_indices());
    for (unsigned int i = 0; i < component.size(); ++i)
      component[i] = kind.local_element(i) < 0.f
                       ? invalid_index
                       : static_cast<unsigned int>(kind.local_element(i));
  }


  template <int n_rows, int n_columns>
  NodeBlocks<n_rows, n_columns>::NodeBlocks(
    const ColumnLayout                   &layout,
    const TrilinosWrappers::SparseMatrix &K,
    const Part                            rows,
    const Part                            columns)
  {
    int    *row_start, *matrix_column;
    double *entries;
    K.trilinos_matrix().ExtractCrsDataPointers(row_start,
                                               matrix_column,
                                               entries);
    first_row = rows == Part::displacements ? 0 : layout.n_u;
    const unsigned int end =
      rows == Part::displacements ? layout.n_u : layout.n;
    // Of the entries that begin a node.
    const unsigned int first_component =
      columns == Part::pressures ? invalid_index : 0;
    std::vector<int> place(layout.component.size());
    start.reserve((end - first_row) / n_rows + 1);
    start.push_back(0);
    std::size_t n_pairs = 0;
    for (unsigned int row = first_row; row < end; row += n_rows)
      n_pairs += std::count_if(matrix_column + row_start[row],
                               matrix_column + row_start[row + 1],
                               [&](const int k) {
                                 return layout.component[layout.entry_of[k]] ==
                                        first_component;
                               });
    column.reserve(n_pairs);
    values.reserve(n_pairs * n_rows * n_columns);
    for (unsigned int row = first_row; row < end; row += n_rows)
      {
        // The rows of a node have the same columns.
        for (int k = row_start[row]; k < row_start[row + 1]; ++k)
          place[layout.entry_of[matrix_column[k]]] = k - row_start[row];
        for (int k = row_start[row]; k < row_start[row + 1]; ++k)
          {
            const unsigned int i = layout.entry_of[matrix_column[k]];
            if (layout.component[i] != first_component)
              continue;
            column.push_back(i);
            for (int r = 0; r < n_rows; ++r)
              for (int c = 0; c < n_columns; ++c)
                values.push_back(entries[row_start[row + r] + place[i + c]]);
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

  template ColumnLayout::ColumnLayout(const System<2> &);
  template ColumnLayout::ColumnLayout(const System<3> &);

  template class NodeBlocks<2, 2>;
  template class NodeBlocks<3, 3>;
  template class NodeBlocks<2, 1>;
  template class NodeBlocks<3, 1>;
  template class NodeBlocks<1, 2>;
  template class NodeBlocks<1, 3>;
  template class NodeBlocks<1, 1>;
} // namespace selkie
