#include <selkie/assembly/tangent_scatter.h>

#include <Epetra_FECrsMatrix.h>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  void
  TangentScatter<dim>::begin(TrilinosWrappers::SparseMatrix &target,
                             const std::vector<int>         &target_columns,
                             const double                    pressure_unit)
  {
    matrix    = &target;
    columns   = &target_columns;
    unit      = pressure_unit;
    *matrix   = 0.;
    auto &crs = const_cast<Epetra_CrsMatrix &>(matrix->trilinos_matrix());
    crs.ExtractCrsDataPointers(row_start, column, values);
    if (positions.size() < static_cast<unsigned int>(crs.NumMyCols()))
      positions.resize(crs.NumMyCols());
  }

  template <int dim>
  void
  TangentScatter<dim>::finish()
  {
    matrix->compress(VectorOperation::add);
  }

  template <int dim>
  void
  TangentScatter<dim>::set_factors(const std::vector<unsigned int> &unknowns,
                                   const DensePatch<dim>           &dense)
  {
    const unsigned int n = dense.n_nodes;
    factors.resize(unknowns.size());
    for (unsigned int i = 0; i < unknowns.size(); ++i)
      factors[i] = system.held(unknowns[i]) ? 0. : i < dim * n ? 1. : unit;
    patch_columns.resize(unknowns.size());
    patch_positions.resize(unknowns.size());
    for (unsigned int i = 0; i < unknowns.size(); ++i)
      patch_columns[i] = (*columns)[unknowns[i]];
  }

  template <int dim>
  void
  TangentScatter<dim>::find_positions(const unsigned int row)
  {
    for (int k = row_start[row]; k < row_start[row + 1]; ++k)
      positions[column[k]] = k - row_start[row];
    for (unsigned int i = 0; i < patch_columns.size(); ++i)
      patch_positions[i] = positions[patch_columns[i]];
  }

  template <int dim>
  void
  TangentScatter<dim>::add(const std::vector<unsigned int> &unknowns,
                           const DensePatch<dim>           &dense)
  {
    set_factors(unknowns, dense);
    for (unsigned int a = 0; a < dense.n_nodes; ++a)
      add_node(a, unknowns, dense);
  }

  /// All rows of one node.
  template <int dim>
  void
  TangentScatter<dim>::add_node(const unsigned int               a,
                                const std::vector<unsigned int> &unknowns,
                                const DensePatch<dim>           &dense)
  {
    const unsigned int n = dense.n_nodes, n_padded = dense.n_padded;
    for (unsigned int c = 0; c < dense.n_components; ++c)
      {
        const unsigned int row    = unknowns[c * n + a];
        const double       factor = factors[c * n + a];
        const double      *block  = dense.row(a, c);
        if (row >= system.n_owned())
          {
            add_to_other_rank(row, factor, unknowns, dense, block);
            continue;
          }
        // The displacement rows of a node share their columns. (The columns of
        // a node of another rank do not follow each other.)
        if (c == 0 || c == dim)
          find_positions(row);
        double *row_values = values + row_start[row];
        if (factor == 0.) // held: the diagonal alone
          {
            row_values[patch_positions[c * n + a]] +=
              (c == dim ? unit * unit : 1.) * block[c * n_padded + a];
            continue;
          }
        for (unsigned int k = 0; k < dense.n_components; ++k)
          for (unsigned int b = 0; b < n; ++b)
            row_values[patch_positions[k * n + b]] +=
              factor * factors[k * n + b] * block[k * n_padded + b];
      }
  }

  template <int dim>
  void
  TangentScatter<dim>::add_to_other_rank(
    const unsigned int               row,
    const double                     factor,
    const std::vector<unsigned int> &unknowns,
    const DensePatch<dim>           &dense,
    const double                    *block)
  {
    const auto        &partition = *system.partitioner();
    const unsigned int n         = dense.n_nodes;
    global_columns.clear();
    row_values.clear();
    for (unsigned int k = 0; k < dense.n_components; ++k)
      for (unsigned int b = 0; b < n; ++b)
        {
          const unsigned int col      = unknowns[k * n + b];
          const bool         diagonal = row == col;
          if (factor * factors[k * n + b] == 0. && !diagonal)
            continue;
          const double own = k == dim ? unit * unit : 1.; // of the diagonal
          global_columns.push_back(partition.local_to_global(col));
          row_values.push_back((diagonal ? own : factor * factors[k * n + b]) *
                               block[k * dense.n_padded + b]);
        }
    matrix->add(partition.local_to_global(row),
                global_columns.size(),
                global_columns.data(),
                row_values.data(),
                false);
  }

  template <int dim>
  void
  TangentScatter<dim>::add_diagonal(const Vector &diagonal)
  {
    for (unsigned int i = 0; i < diagonal.locally_owned_size(); ++i)
      if (diagonal.local_element(i) != 0.)
        for (int k = row_start[i]; k < row_start[i + 1]; ++k)
          if (column[k] == (*columns)[i])
            {
              values[k] += diagonal.local_element(i);
              break;
            }
  }

  template class TangentScatter<2>;
  template class TangentScatter<3>;
} // namespace selkie
