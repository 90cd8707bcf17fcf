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
                                   const SupportTable<dim> &table,
                                   const double             pressure_unit)
  {
    static_assert(lme_padding % lanes == 0,
                  "node lists must be padded to full lanes");
    unit                   = pressure_unit;
    layout.partition       = system.partitioner();
    layout.n_displacements = system.n_owned_displacements();
    layout.cells.clear();
    layout.first_unknowns.clear();
    layout.pressures.clear();
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
    pressure_forms.clear();
    std::size_t n_groups = 0, n_pressure_groups = 0;
    for (const auto &patch : table.patches)
      {
        const unsigned int n = (patch.n_points + lanes - 1) / lanes;
        n_groups += n;
        n_pressure_groups += patch.pressure ? n : 0;
      }
    forms.reserve(n_groups);
    pressure_forms.reserve(n_pressure_groups);
    functions = table.data.data();
    initialize(diagonal);
    initialize(wide);
  }

  /// A patch, with room for what belongs to it. (Sizes are those of the largest
  /// patch.)
  template <int dim, typename Number>
  typename PointTangent<dim, Number>::Cell
  PointTangent<dim, Number>::add_cell(Cell cell)
  {
    const unsigned int n_groups  = (cell.n_points + lanes - 1) / lanes;
    const unsigned int n_columns = cell.pressure ? dim + 1 : dim;
    cell.first_forms             = forms.size();
    cell.first_pressure_forms    = pressure_forms.size();
    forms.resize(forms.size() + n_groups);
    if (cell.pressure)
      pressure_forms.resize(pressure_forms.size() + n_groups);
    values.resize(
      std::max<std::size_t>(values.size(), n_columns * cell.n_padded));
    fluxes.resize(
      std::max<std::size_t>(fluxes.size(),
                            n_groups * lanes *
                              PatchProduct<dim, Number, true, true>::n_fluxes));
    layout.cells.push_back(cell);
    return cell;
  }

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::add(const std::vector<unsigned int> &unknowns,
                                 const PatchState<dim>           &state,
                                 const bool                       with_mass,
                                 const bool                       with_pressure)
  {
    const Patch<dim> &patch = *state.patch;
    Cell              cell;
    cell.n_points       = patch.n_points;
    cell.n_nodes        = patch.n_nodes;
    cell.n_padded       = patch.n_padded;
    cell.mass           = with_mass;
    cell.pressure       = with_pressure;
    cell.n_rows         = with_mass || with_pressure ? dim + 1 : dim;
    cell.first_node     = layout.first_unknowns.size();
    cell.first_pressure = layout.pressures.size();
    cell.functions      = patch.data + (dim + 1 - cell.n_rows) * patch.n_padded;
    cell.stride         = std::size_t(dim + 1) * patch.n_padded;
    cell                = add_cell(cell);
    layout.first_unknowns.insert(layout.first_unknowns.end(),
                                 unknowns.begin(),
                                 unknowns.begin() + patch.n_nodes);
    for (unsigned int q = 0; q < patch.n_points; ++q)
      {
        const PointForm<dim> &from = state.forms[q];
        auto                 &to   = forms[cell.first_forms + q / lanes];
        const unsigned int    lane = q % lanes;
        to.mass[lane]              = from.mass;
        for (unsigned int j = 0; j < dim; ++j)
          for (unsigned int l = 0; l < dim; ++l)
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int k = 0; k < dim; ++k)
                to.stiffness[i][j][k][l][lane] = from.stiffness[j][l][i][k];
      }
    if (with_pressure)
      add_pressures(unknowns, state, cell);
    add_held_diagonal(cell);
  }

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::add_pressures(
    const std::vector<unsigned int> &unknowns,
    const PatchState<dim>           &state,
    const Cell                      &cell)
  {
    const auto first = unknowns.begin() + dim * cell.n_nodes;
    layout.pressures.insert(layout.pressures.end(),
                            first,
                            first + cell.n_nodes);
    for (unsigned int q = 0; q < cell.n_points; ++q)
      {
        const PointForm<dim> &from = state.forms[q];
        auto &to = pressure_forms[cell.first_pressure_forms + q / lanes];
        const unsigned int lane   = q % lanes;
        const double       lumped = unit * unit * from.lumped;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            to.coupling[i][j][lane] = unit * from.coupling[i][j];
        to.stiffness[lane] = unit * unit * from.p_stiffness - lumped;
        const Number *N_q  = N(cell) + q * cell.stride;
        for (unsigned int a = 0; a < cell.n_nodes; ++a)
          diagonal.local_element(first[a]) += lumped * N_q[a];
      }
  }

  /// Held unknowns keep their diagonal.
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
    if (std::any_of(first, first + cell.n_nodes, held))
      for_each_block(cell, [&](const unsigned int unknown, const auto &block) {
        for (unsigned int d = 0; d < dim; ++d)
          if (layout.is_held[unknown + d])
            diagonal.local_element(unknown + d) += block[d][d];
      });
    if (cell.pressure)
      for_each_pressure(cell, [&](const unsigned int unknown, const Number C) {
        if (layout.is_held[unknown])
          diagonal.local_element(unknown) += C;
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
    , layout(other.layout)
    , unit(other.unit)
  {
    layout.cells.clear();
    initialize(diagonal);
    diagonal.copy_locally_owned_data_from(other.diagonal);
    initialize(wide);
    layout.pressures.clear();
    std::size_t n_functions = 0, n_forms = 0;
    for (const Cell &cell : other.layout.cells)
      {
        n_functions += cell.n_points * (dim + cell.mass) * cell.n_padded;
        n_forms += (cell.n_points + lanes - 1) / lanes;
      }
    forms.reserve(n_forms);
    own_functions.resize_fast(n_functions);
    functions    = own_functions.data();
    Number *next = own_functions.data();
    for (const Cell &from : other.layout.cells)
      {
        Cell cell      = from;
        cell.pressure  = false;
        cell.n_rows    = dim + cell.mass;
        cell.functions = next - functions;
        cell.stride    = cell.n_rows * cell.n_padded;
        copy_forms(other, from, add_cell(cell));
        const double *rows =
          other.N(from) + (from.n_rows - cell.n_rows) * cell.n_padded;
        for (unsigned int q = 0; q < from.n_points; ++q, rows += from.stride)
          next = std::copy(rows, rows + cell.stride, next);
      }
  }

  template <int dim, typename Number>
  void
  PointTangent<dim, Number>::copy_forms(const PointTangent<dim, double> &other,
                                        const Cell                      &from,
                                        const Cell                      &to)
  {
    constexpr unsigned int width = PointTangent<dim, double>::lanes;
    for (unsigned int q = 0; q < from.n_points; ++q)
      {
        const auto        &in  = other.forms[from.first_forms + q / width];
        auto              &out = forms[to.first_forms + q / lanes];
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
        if (cell.pressure)
          cell.mass ? multiply<true, true>(cell, y.begin())
                    : multiply<false, true>(cell, y.begin());
        else
          cell.mass ? multiply<true, false>(cell, y.begin())
                    : multiply<false, false>(cell, y.begin());
      }
    y.compress(VectorOperation::add);
    for (const unsigned int i : layout.held)
      y.local_element(i) = 0;
    for (unsigned int i = 0; i < diagonal.locally_owned_size(); ++i)
      y.local_element(i) += diagonal.local_element(i) * x.local_element(i);
  }

  template <int dim, typename Number>
  template <bool mass, bool pressure>
  void
  PointTangent<dim, Number>::multiply(const Cell &cell, Number *y) const
  {
    const auto *u = layout.first_unknowns.data() + cell.first_node;
    const auto *p = layout.pressures.data() + cell.first_pressure;
    const PatchProduct<dim, Number, mass, pressure> product{
      cell.n_points,
      cell.n_nodes,
      cell.n_padded,
      N(cell),
      G(cell),
      cell.stride,
      forms.data() + cell.first_forms,
      pressure_forms.data() + cell.first_pressure_forms,
      values.data(),
      fluxes.data()};
    product.set_fluxes();
    product.integrate([&](const unsigned int a,
                          const unsigned int i,
                          const Number       force) { y[u[a] + i] += force; },
                      [&](const unsigned int a, const Number force) {
                        y[p[a]] += force;
                      });
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
    if (cell.pressure)
      {
        const auto *p = layout.pressures.data() + cell.first_pressure;
        for (unsigned int a = 0; a < cell.n_nodes; ++a)
          to[dim * cell.n_padded + a] = from[p[a]];
      }
    for (unsigned int d = 0; d < (cell.pressure ? dim + 1u : dim); ++d)
      std::fill(to + d * cell.n_padded + cell.n_nodes,
                to + (d + 1) * cell.n_padded,
                Number(0));
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

    std::vector<Tensor<2, dim, Number>> blocks(layout.n_displacements / dim);
    for (unsigned int i = 0; i < layout.n_displacements; ++i)
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
        find_blocks(cell, a, sum);
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
  void
  PointTangent<dim, Number>::find_blocks(const Cell        &cell,
                                         const unsigned int a,
                                         Lanes (&blocks)[dim][dim]) const
  {
    const Number *N_q = N(cell) + a, *G_q = G(cell) + a;
    for (unsigned int q = 0; q < cell.n_points;
         ++q, N_q += cell.stride, G_q += cell.stride)
      {
        const auto        &form = forms[cell.first_forms + q / lanes];
        const unsigned int lane = q % lanes;
        Lanes              G_a[dim];
#pragma GCC unroll 4
        for (int j = 0; j < dim; ++j)
          G_a[j] = simd::load<Lanes>(G_q + j * cell.n_padded);
        if (cell.mass)
          {
            const Lanes N_a = simd::load<Lanes>(N_q);
#pragma GCC unroll 4
            for (int i = 0; i < dim; ++i)
              blocks[i][i] += form.mass[lane] * N_a * N_a;
          }
#pragma GCC unroll 4
        for (int i = 0; i < dim; ++i)
#pragma GCC unroll 4
          for (int k = 0; k < dim; ++k)
#pragma GCC unroll 4
            for (int j = 0; j < dim; ++j)
              {
                Lanes sum{};
#pragma GCC unroll 4
                for (int l = 0; l < dim; ++l)
                  sum += form.stiffness[i][j][k][l][lane] * G_a[l];
                blocks[i][k] += sum * G_a[j];
              }
      }
  }

  /// Calls action(unknown, C_aa) for each pressure of a patch, without what is
  /// lumped.
  template <int dim, typename Number>
  template <typename Action>
  void
  PointTangent<dim, Number>::for_each_pressure(const Cell   &cell,
                                               const Action &action) const
  {
    const auto *unknowns = layout.pressures.data() + cell.first_pressure;
    for (unsigned int a = 0; a < cell.n_nodes; ++a)
      {
        Number        C   = 0;
        const Number *N_a = N(cell) + a;
        for (unsigned int q = 0; q < cell.n_points; ++q, N_a += cell.stride)
          C += pressure_forms[cell.first_pressure_forms + q / lanes]
                 .stiffness[q % lanes] *
               *N_a * *N_a;
        action(unknowns[a], C);
      }
  }

  template <int dim, typename Number>
  std::size_t
  PointTangent<dim, Number>::memory_consumption() const
  {
    return layout.cells.size() * sizeof(Cell) +
           (layout.first_unknowns.size() + layout.pressures.size()) *
             sizeof(unsigned int) +
           forms.size() * sizeof(forms[0]) +
           pressure_forms.size() * sizeof(pressure_forms[0]) +
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
