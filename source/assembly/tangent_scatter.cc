#include <selkie/assembly/tangent_scatter.h>
#include <selkie/shape/simd.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  void
  TangentScatter<dim>::begin(SystemMatrix &target, const double pressure_unit)
  {
    matrix = &target;
    unit   = pressure_unit;
    matrix->clear();
  }

  template <int dim>
  void
  TangentScatter<dim>::finish()
  {
    matrix->compress();
  }

  /// The patch's columns as runs. Nodes are listed by position, as unknowns are
  /// numbered, so that a line of nodes of a lattice is one run.
  template <int dim>
  void
  TangentScatter<dim>::set_columns(const std::vector<unsigned int> &unknowns,
                                   const DensePatch<dim>           &dense)
  {
    const unsigned int n = dense.n_nodes;
    columns.clear();
    const auto append = [this](const types::global_dof_index begin,
                               const unsigned int            length,
                               const bool                    pressures,
                               const unsigned int            position) {
      if (!columns.empty() && columns.back().end == begin &&
          columns.back().pressures == pressures &&
          columns.back().position + columns.back().length() == position)
        columns.back().end += length;
      else
        columns.push_back({begin, begin + length, pressures, position});
    };
    for (unsigned int a = 0; a < n; ++a)
      append(matrix->column(unknowns[a]), dim, false, dense.place(a, 0));
    if (dense.n_components > dim)
      for (unsigned int a = 0; a < n; ++a)
        append(matrix->column(unknowns[dim * n + a]),
               1,
               true,
               dense.place(a, dim));
    std::sort(columns.begin(),
              columns.end(),
              [](const ColumnRun &a, const ColumnRun &b) {
                return a.begin < b.begin;
              });
    positions.resize(columns.size());
  }

  template <int dim>
  void
  TangentScatter<dim>::set_factors(const std::vector<unsigned int> &unknowns,
                                   const DensePatch<dim>           &dense)
  {
    free = true;
    factors.resize(dense.row_length());
    for (unsigned int c = 0; c < dense.n_components; ++c)
      for (unsigned int a = 0; a < dense.n_nodes; ++a)
        {
          const double factor = system.held(unknowns[c * dense.n_nodes + a])
                                  ? 0.
                                : c < dim ? 1.
                                          : unit;
          factors[dense.place(a, c)] = factor;
          free                       = free && factor != 0.;
        }
  }

  template <int dim>
  void
  TangentScatter<dim>::add(const std::vector<unsigned int> &unknowns,
                           const DensePatch<dim>           &dense)
  {
    set_columns(unknowns, dense);
    set_factors(unknowns, dense);
    for (unsigned int a = 0; a < dense.n_nodes; ++a)
      for (unsigned int c = 0; c < dense.n_components; ++c)
        {
          const unsigned int row = unknowns[c * dense.n_nodes + a];
          if (c == 0 || c == dim) // the displacement's rows share their columns
            {
              unsigned int run = 0;
              for_each_position(matrix->group(row).columns,
                                columns,
                                [&](const unsigned int position,
                                    const ColumnRun &) {
                                  positions[run++] = position;
                                });
            }
          add_row(row, dense.place(a, c), dense.row(a, c));
        }
  }

  namespace
  {
    /// to += factor from.
    void
    add_numbers(const double       factor,
                const double      *from,
                const unsigned int n,
                double            *to)
    {
      using namespace simd;
      unsigned int k   = 0;
      const auto   add = [&](auto lanes) {
        lanes = load<decltype(lanes)>(to + k) +
                factor * load<decltype(lanes)>(from + k);
        store(lanes, to + k);
        k += n_lanes<decltype(lanes)>;
      };
      while (k + 8 <= n)
        add(Eight());
      if (k + 4 <= n)
        add(Four());
      if (k + 2 <= n)
        add(Two());
      if (k < n)
        to[k] += factor * from[k];
    }
  } // namespace

  /// @param place of the row among the patch's unknowns
  template <int dim>
  void
  TangentScatter<dim>::add_row(const unsigned int row,
                               const unsigned int place,
                               const double      *block)
  {
    double      *values = matrix->row_values(row);
    const double factor = factors[place];
    if (free)
      {
        for (unsigned int i = 0; i < columns.size(); ++i)
          add_numbers(columns[i].pressures ? factor * unit : factor,
                      block + columns[i].position,
                      columns[i].length(),
                      values + positions[i]);
        return;
      }
    for (unsigned int i = 0; i < columns.size(); ++i)
      for (unsigned int k = 0; k < columns[i].length(); ++k)
        {
          const unsigned int other = columns[i].position + k;
          if (other == place) // a held row has its diagonal alone
            values[positions[i] + k] +=
              (columns[i].pressures ? unit * unit : 1.) * block[other];
          else
            values[positions[i] + k] += factor * factors[other] * block[other];
        }
  }

  template <int dim>
  void
  TangentScatter<dim>::add_diagonal(const Vector &diagonal)
  {
    for (unsigned int i = 0; i < diagonal.locally_owned_size(); ++i)
      if (diagonal.local_element(i) != 0.)
        matrix->add(i, i, diagonal.local_element(i));
  }

  template class TangentScatter<2>;
  template class TangentScatter<3>;
} // namespace selkie
