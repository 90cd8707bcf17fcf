#include <selkie/assembly/point_tangent.h>
#include <selkie/assembly/system.h>
#include <selkie/shape/lme.h>

#include <algorithm>
#include <array>

namespace selkie
{
  using namespace dealii;

  // --- filling ---------------------------------------------------------------

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::begin(const System<dim>       &system,
                                   const SupportTable<dim> &table)
  {
    static_assert(lme_padding % lanes == 0,
                  "node lists must be padded to full lanes");
    layout.partition = system.partitioner();
    layout.cells.clear();
    layout.first_unknowns.clear();
    layout.held.clear();
    const unsigned int n_owned = layout.partition->locally_owned_size();
    layout.is_held.resize(n_owned + layout.partition->n_ghost_indices());
    for (unsigned int i = 0; i < layout.is_held.size(); ++i)
      {
        layout.is_held[i] = system.held(i);
        if (layout.is_held[i] && i < n_owned)
          layout.held.push_back(i);
      }
    forms.clear();
    std::size_t n_groups = 0;
    for (const auto &patch : table.patches)
      n_groups += (patch.n_points + lanes - 1) / lanes;
    forms.reserve(n_groups);
    functions = table.data.data();
    initialize(diagonal);
    initialize(wide);
  }

  /// A patch, with room for what belongs to it. (Sizes are those of the largest
  /// patch.)
  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::add_cell(Cell cell)
  {
    const unsigned int n_groups = (cell.n_points + lanes - 1) / lanes;
    cell.first_forms            = forms.size();
    layout.cells.push_back(cell);
    forms.resize(forms.size() + n_groups);
    values.resize(std::max<std::size_t>(values.size(), dim * cell.n_padded));
    fluxes.resize(
      std::max<std::size_t>(fluxes.size(), n_groups * lanes * dim * (dim + 1)));
  }

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::add(const std::vector<unsigned int> &unknowns,
                                 const PatchState<dim>           &state,
                                 const bool                       with_mass)
  {
    const Patch<dim> &patch = *state.patch;
    const std::size_t first = patch.data + (with_mass ? 0 : patch.n_padded);
    add_cell({patch.n_points,
              patch.n_nodes,
              patch.n_padded,
              with_mass ? dim + 1u : dim,
              unsigned(layout.first_unknowns.size()),
              0,
              first,
              std::size_t(dim + 1) * patch.n_padded});
    layout.first_unknowns.insert(layout.first_unknowns.end(),
                                 unknowns.begin(),
                                 unknowns.begin() + patch.n_nodes);
    const Cell &cell = layout.cells.back();
    for (unsigned int q = 0; q < patch.n_points; ++q)
      {
        const PointForm<dim> &from = state.forms[q];
        Forms                &to   = forms[cell.first_forms + q / lanes];
        const unsigned int    lane = q % lanes;
        to.mass[lane]              = from.mass;
        for (unsigned int j = 0; j < dim; ++j)
          for (unsigned int l = 0; l < dim; ++l)
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int k = 0; k < dim; ++k)
                to.stiffness[i][j][k][l][lane] = from.stiffness[j][l][i][k];
      }
    add_held_diagonal(cell);
  }

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::add_held_diagonal(const Cell &cell)
  {
    const auto *first = layout.first_unknowns.data() + cell.first_node;
    const auto  held  = [&](const unsigned int unknown) {
      for (unsigned int d = 0; d < dim; ++d)
        if (layout.is_held[unknown + d])
          return true;
      return false;
    };
    if (std::none_of(first, first + cell.n_nodes, held))
      return;
    for_each_block(cell, [&](const unsigned int unknown, const auto &block) {
      for (unsigned int d = 0; d < dim; ++d)
        if (layout.is_held[unknown + d])
          diagonal.local_element(unknown + d) += block[d][d];
    });
  }

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::finish()
  {
    diagonal.compress(VectorOperation::add);
  }

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::add_diagonal(const Vector &more)
  {
    for (unsigned int i = 0; i < more.locally_owned_size(); ++i)
      diagonal.local_element(i) += more.local_element(i);
  }

  // --- a copy ----------------------------------------------------------------

  template <int dim, typename Number>
  PointTangent<dim, Number>::PointTangent(
    const PointTangent<dim, double> &other)
    : Subscriptor()
  {
    layout = other.layout;
    layout.cells.clear();
    initialize(diagonal);
    diagonal.copy_locally_owned_data_from(other.diagonal);
    initialize(wide);
    std::size_t n_functions = 0, n_forms = 0;
    for (const Cell &cell : other.layout.cells)
      {
        n_functions += cell.n_points * cell.n_rows * cell.n_padded;
        n_forms += (cell.n_points + lanes - 1) / lanes;
      }
    forms.reserve(n_forms);
    own_functions.resize_fast(n_functions);
    functions    = own_functions.data();
    Number *next = own_functions.data();
    for (const Cell &from : other.layout.cells)
      {
        Cell cell      = from;
        cell.functions = next - functions;
        cell.stride    = cell.n_rows * cell.n_padded;
        add_cell(cell);
        copy_forms(other, from);
        const double *rows = other.functions + from.functions;
        for (unsigned int q = 0; q < from.n_points; ++q, rows += from.stride)
          next = std::copy(rows, rows + cell.stride, next);
      }
  }

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::copy_forms(const PointTangent<dim, double> &other,
                                        const Cell                      &from)
  {
    constexpr unsigned int width = PointTangent<dim, double>::lanes;
    const unsigned int     first = layout.cells.back().first_forms;
    for (unsigned int q = 0; q < from.n_points; ++q)
      {
        const auto        &in  = other.forms[from.first_forms + q / width];
        Forms             &out = forms[first + q / lanes];
        const unsigned int i = q % width, o = q % lanes;
        out.mass[o] = in.mass[i];
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                out.stiffness[a][b][c][d][o] = in.stiffness[a][b][c][d][i];
      }
  }

  // --- products --------------------------------------------------------------

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::vmult(VectorType &y, const VectorType &x) const
  {
    wide.zero_out_ghost_values();
    wide.copy_locally_owned_data_from(x);
    for (const unsigned int i : layout.held)
      wide.local_element(i) = 0;
    wide.update_ghost_values();
    y = 0;
    for (const Cell &cell : layout.cells)
      {
        gather(cell);
        if (cell.n_rows == dim)
          apply<dim>(cell, y.begin());
        else
          apply<dim + 1>(cell, y.begin());
      }
    y.compress(VectorOperation::add);
    for (const unsigned int i : layout.held)
      y.local_element(i) = 0;
    for (unsigned int i = 0; i < diagonal.locally_owned_size(); ++i)
      y.local_element(i) += diagonal.local_element(i) * x.local_element(i);
  }

  /// The vector at the nodes of a patch, padded with zeros.
  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::gather(const Cell &cell) const
  {
    Number       *to    = values.data();
    const Number *from  = wide.begin();
    const auto   *first = layout.first_unknowns.data() + cell.first_node;
    for (unsigned int a = 0; a < cell.n_nodes; ++a)
#pragma GCC unroll 4
      for (int d = 0; d < dim; ++d)
        to[d * cell.n_padded + a] = from[first[a] + d];
    for (unsigned int d = 0; d < dim; ++d)
      std::fill(to + d * cell.n_padded + cell.n_nodes,
                to + (d + 1) * cell.n_padded,
                Number(0));
  }

  /// Points are in the lanes while forms are applied, nodes before and after.
  template <int dim, typename Number>
  template <int n_rows>
  void
  PointTangent<dim, Number>::apply(const Cell &cell, Number *y) const
  {
    const Number *rows = functions + cell.functions;
    for (unsigned int first = 0; first < cell.n_points; first += lanes)
      {
        const unsigned int n = std::min(lanes, cell.n_points - first);
        Lanes              gathered[dim][n_rows] = {}, flux[dim][n_rows];
        for (unsigned int lane = 0; lane < n; ++lane, rows += cell.stride)
          interpolate<n_rows>(cell, rows, lane, gathered);
        forms[cell.first_forms + first / lanes].apply(gathered, flux);
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int r = 0; r < n_rows; ++r)
            for (unsigned int lane = 0; lane < n; ++lane)
              fluxes[((first + lane) * n_rows + r) * dim + i] =
                flux[i][r][lane];
      }
    add_forces<n_rows>(cell, y);
  }

  /// sum_a values_a (x) rows_a for one point, in its lane.
  template <int dim, typename Number>
  template <int n_rows>
  void
  PointTangent<dim, Number>::interpolate(const Cell        &cell,
                                         const Number      *rows,
                                         const unsigned int lane,
                                         Lanes (&result)[dim][n_rows]) const
  {
    Lanes sum[dim][n_rows] = {};
    for (unsigned int a = 0; a < cell.n_padded; a += lanes)
      {
        Lanes row[n_rows];
#pragma GCC unroll 4
        for (int r = 0; r < n_rows; ++r)
          row[r] = simd::load<Lanes>(rows + r * cell.n_padded + a);
#pragma GCC unroll 4
        for (int i = 0; i < dim; ++i)
          {
            const Lanes x =
              simd::load<Lanes>(values.data() + i * cell.n_padded + a);
#pragma GCC unroll 4
            for (int r = 0; r < n_rows; ++r)
              sum[i][r] += x * row[r];
          }
      }
#pragma GCC unroll 4
    for (int i = 0; i < dim; ++i)
#pragma GCC unroll 4
      for (int r = 0; r < n_rows; ++r)
        result[i][r][lane] = simd::sum(sum[i][r]);
  }

  template <int dim, typename Number>
  template <int n_rows>
  void
  PointTangent<dim, Number>::Forms::apply(const Lanes (&x)[dim][n_rows],
                                          Lanes (&flux)[dim][n_rows]) const
  {
    constexpr int first = n_rows - dim; // of the gradients
#pragma GCC unroll 4
    for (int i = 0; i < dim; ++i)
      {
        if (first == 1)
          flux[i][0] = mass * x[i][0];
#pragma GCC unroll 4
        for (int j = 0; j < dim; ++j)
          {
            Lanes sum{};
#pragma GCC unroll 4
            for (int k = 0; k < dim; ++k)
#pragma GCC unroll 4
              for (int l = 0; l < dim; ++l)
                sum += stiffness[i][j][k][l] * x[k][first + l];
            flux[i][first + j] = sum;
          }
      }
  }

  template <int dim, typename Number>
  template <int n_rows>
  void
  PointTangent<dim, Number>::add_forces(const Cell &cell, Number *y) const
  {
    const auto *to = layout.first_unknowns.data() + cell.first_node;
    for (unsigned int a = 0; a < cell.n_nodes; a += lanes)
      {
        const Number *rows     = functions + cell.functions + a;
        const Number *flux     = fluxes.data();
        Lanes         sum[dim] = {};
        for (unsigned int q = 0; q < cell.n_points; ++q, rows += cell.stride)
#pragma GCC unroll 4
          for (int r = 0; r < n_rows; ++r, flux += dim)
            {
              const Lanes row = simd::load<Lanes>(rows + r * cell.n_padded);
#pragma GCC unroll 4
              for (int i = 0; i < dim; ++i)
                sum[i] += flux[i] * row;
            }
        const unsigned int n = std::min(lanes, cell.n_nodes - a);
        for (unsigned int lane = 0; lane < n; ++lane)
#pragma GCC unroll 4
          for (int i = 0; i < dim; ++i)
            y[to[a + lane] + i] += sum[i][lane];
      }
  }

  // --- the diagonal ----------------------------------------------------------

  template <int dim, typename Number>
  std::vector<Tensor<2, dim, Number>>
  PointTangent<dim, Number>::node_blocks() const
  {
    std::array<VectorType, dim> columns;
    for (auto &column : columns)
      initialize(column);
    for (const Cell &cell : layout.cells)
      for_each_block(cell, [&](const unsigned int unknown, const auto &block) {
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int k = 0; k < dim; ++k)
            columns[k].local_element(unknown + i) += block[i][k];
      });
    for (auto &column : columns)
      column.compress(VectorOperation::add);

    std::vector<Tensor<2, dim, Number>> blocks(diagonal.locally_owned_size() /
                                               dim);
    for (unsigned int i = 0; i < diagonal.locally_owned_size(); ++i)
      for (unsigned int k = 0; k < dim; ++k)
        {
          Number    &entry = blocks[i / dim][i % dim][k];
          const bool held =
            layout.is_held[i] || layout.is_held[i / dim * dim + k];
          entry = held ? Number(0) : columns[k].local_element(i);
          if (k == i % dim)
            entry += diagonal.local_element(i);
        }
    return blocks;
  }

  /// Calls action(first unknown, block) for each node of a patch.
  template <int dim, typename Number>
  template <typename Action>
  void
  PointTangent<dim, Number>::for_each_block(const Cell   &cell,
                                            const Action &action) const
  {
    const auto *unknowns = layout.first_unknowns.data() + cell.first_node;
    for (unsigned int a = 0; a < cell.n_nodes; a += lanes)
      {
        Lanes sum[dim][dim] = {};
        if (cell.n_rows == dim)
          find_blocks<dim>(cell, a, sum);
        else
          find_blocks<dim + 1>(cell, a, sum);
        const unsigned int n = std::min(lanes, cell.n_nodes - a);
        for (unsigned int lane = 0; lane < n; ++lane)
          {
            Tensor<2, dim, Number> block;
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int k = 0; k < dim; ++k)
                block[i][k] = sum[i][k][lane];
            action(unknowns[a + lane], block);
          }
      }
  }

  /// Those of as many nodes as there are lanes, from node a on.
  template <int dim, typename Number>
  template <int n_rows>
  void
  PointTangent<dim, Number>::find_blocks(const Cell        &cell,
                                         const unsigned int a,
                                         Lanes (&blocks)[dim][dim]) const
  {
    const Number *rows = functions + cell.functions + a;
    for (unsigned int q = 0; q < cell.n_points; ++q, rows += cell.stride)
      {
        const Forms       &form = forms[cell.first_forms + q / lanes];
        const unsigned int lane = q % lanes;
        Lanes              G[dim];
#pragma GCC unroll 4
        for (int j = 0; j < dim; ++j)
          G[j] = simd::load<Lanes>(rows + (n_rows - dim + j) * cell.n_padded);
#pragma GCC unroll 4
        for (int i = 0; i < dim; ++i)
          {
            if constexpr (n_rows > dim)
              {
                const Lanes N = simd::load<Lanes>(rows);
                blocks[i][i] += form.mass[lane] * N * N;
              }
#pragma GCC unroll 4
            for (int k = 0; k < dim; ++k)
#pragma GCC unroll 4
              for (int j = 0; j < dim; ++j)
                {
                  Lanes sum{};
#pragma GCC unroll 4
                  for (int l = 0; l < dim; ++l)
                    sum += form.stiffness[i][j][k][l][lane] * G[l];
                  blocks[i][k] += sum * G[j];
                }
          }
      }
  }

  template <int dim, typename Number>
  std::size_t
  PointTangent<dim, Number>::memory_consumption() const
  {
    return layout.cells.size() * sizeof(Cell) +
           layout.first_unknowns.size() * sizeof(unsigned int) +
           forms.size() * sizeof(Forms) +
           (2 * diagonal.locally_owned_size() + own_functions.size()) *
             sizeof(Number);
  }

  // Copies are not filled.
#define INSTANTIATE(dim)                                                   \
  template class PointTangent<dim, double>;                                \
  template PointTangent<dim, float>::PointTangent(                         \
    const PointTangent<dim, double> &);                                    \
  template void PointTangent<dim, float>::vmult(VectorType &,              \
                                                const VectorType &) const; \
  template std::vector<Tensor<2, dim, float>>                              \
                       PointTangent<dim, float>::node_blocks() const;      \
  template std::size_t PointTangent<dim, float>::memory_consumption() const
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
