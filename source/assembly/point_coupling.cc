#include <selkie/assembly/point_coupling.h>
#include <selkie/shape/simd.h>

#include <algorithm>

namespace selkie
{
  using namespace dealii;

  // --- a copy ----------------------------------------------------------------

  template <int dim>
  PointCoupling<dim>::PointCoupling(const PointTangent<dim, double> &tangent)
    : held(tangent.layout.held)
    , first_pressure(tangent.layout.n_displacements)
  {
    std::size_t  n_functions = 0;
    unsigned int n_points = 0, largest = 0, most_points = 0;
    for (const auto &cell : tangent.layout.cells)
      if (cell.pressure)
        {
          n_points += cell.n_points;
          n_functions += std::size_t(cell.n_points) * (dim + 1) * cell.n_padded;
          largest     = std::max(largest, cell.n_padded);
          most_points = std::max(most_points, cell.n_points);
        }
    functions.resize_fast(n_functions);
    stiffnesses.reserve(n_points);
    displacements.reserve(tangent.layout.pressures.size());
    pressures = tangent.layout.pressures;
    values.resize((dim + 1) * largest);
    fluxes.resize(most_points);
    float *next = functions.data();
    for (const auto &cell : tangent.layout.cells)
      if (cell.pressure)
        add_cell(tangent, cell, next);
    diagonal.reinit(tangent.layout.partition);
    diagonal.copy_locally_owned_data_from(tangent.diagonal);
    wide.reinit(tangent.layout.partition);
  }

  template <int dim>
  void
  PointCoupling<dim>::add_cell(const PointTangent<dim, double>         &tangent,
                               const typename PointTangentLayout::Cell &from,
                               float                                  *&next)
  {
    constexpr unsigned int width  = PointTangent<dim, double>::lanes;
    const unsigned int     stride = from.n_padded;
    cells.push_back({from.n_points,
                     from.n_nodes,
                     from.n_padded,
                     static_cast<unsigned int>(displacements.size()),
                     static_cast<unsigned int>(stiffnesses.size()),
                     static_cast<std::size_t>(next - functions.data())});
    const auto first = tangent.layout.first_unknowns.begin() + from.first_node;
    displacements.insert(displacements.end(), first, first + from.n_nodes);
    const double *N = tangent.N(from), *G = tangent.G(from);
    for (unsigned int q = 0; q < from.n_points;
         ++q, N += from.stride, G += from.stride)
      {
        const auto &form =
          tangent.pressure_forms[from.first_pressure_forms + q / width];
        stiffnesses.push_back(form.stiffness[q % width]);
        next = std::copy(N, N + stride, next);
        for (unsigned int i = 0; i < dim; ++i, next += stride)
          for (unsigned int a = 0; a < stride; ++a)
            {
              double D = 0.;
              for (unsigned int j = 0; j < dim; ++j)
                D += form.coupling[i][j][q % width] * G[j * stride + a];
              next[a] = D;
            }
      }
  }

  // --- products --------------------------------------------------------------

  template <int dim>
  void
  PointCoupling<dim>::vmult_B(VectorType &y, const VectorType &x) const
  {
    distribute(x);
    y = 0.f;
    for (const Cell &cell : cells)
      add_B(cell, y.begin());
    collect(y);
  }

  template <int dim>
  void
  PointCoupling<dim>::vmult_pressures(VectorType &y, const VectorType &x) const
  {
    distribute(x);
    y = 0.f;
    for (const Cell &cell : cells)
      add_pressures(cell, y.begin());
    collect(y);
    for (unsigned int i = first_pressure; i < y.locally_owned_size(); ++i)
      y.local_element(i) += diagonal.local_element(i) * x.local_element(i);
  }

  /// Prescribed unknowns have no columns and, below, no rows but their
  /// diagonal.
  template <int dim>
  void
  PointCoupling<dim>::distribute(const VectorType &x) const
  {
    wide.zero_out_ghost_values();
    wide.copy_locally_owned_data_from(x);
    for (const unsigned int i : held)
      wide.local_element(i) = 0.f;
    wide.update_ghost_values();
  }

  template <int dim>
  void
  PointCoupling<dim>::collect(VectorType &y) const
  {
    y.compress(VectorOperation::add);
    for (const unsigned int i : held)
      y.local_element(i) = 0.f;
  }

  template <int dim>
  void
  PointCoupling<dim>::add_B(const Cell &cell, float *y) const
  {
    const unsigned int n_padded = cell.n_padded;
    const unsigned int stride   = (dim + 1) * n_padded;
    const auto        *p        = pressures.data() + cell.first_node;
    const auto        *u        = displacements.data() + cell.first_node;
    for (unsigned int a = 0; a < cell.n_nodes; ++a)
      values[a] = wide.local_element(p[a]);
    std::fill(values.begin() + cell.n_nodes, values.begin() + n_padded, 0.f);

    const float *N = functions.data() + cell.functions;
    for (unsigned int q = 0; q < cell.n_points; ++q, N += stride)
      {
        Lanes sum{};
        for (unsigned int a = 0; a < n_padded; a += lanes)
          sum +=
            simd::load<Lanes>(N + a) * simd::load<Lanes>(values.data() + a);
        fluxes[q] = simd::sum(sum);
      }
    for (unsigned int a = 0; a < cell.n_nodes; a += lanes)
      {
        Lanes        force[dim] = {};
        const float *D = functions.data() + cell.functions + n_padded + a;
        for (unsigned int q = 0; q < cell.n_points; ++q, D += stride)
#pragma GCC unroll 4
          for (int i = 0; i < dim; ++i)
            force[i] += fluxes[q] * simd::load<Lanes>(D + i * n_padded);
        const unsigned int n = std::min(lanes, cell.n_nodes - a);
        for (unsigned int lane = 0; lane < n; ++lane)
#pragma GCC unroll 4
          for (int i = 0; i < dim; ++i)
            y[u[a + lane] + i] += force[i][lane];
      }
  }

  /// Values at the nodes of a patch, component-major, padded with zeros; the
  /// pressures first.
  template <int dim>
  void
  PointCoupling<dim>::gather(const Cell &cell) const
  {
    const unsigned int n_padded = cell.n_padded;
    const auto        *p        = pressures.data() + cell.first_node;
    const auto        *u        = displacements.data() + cell.first_node;
    const float       *from     = wide.begin();
    float             *to       = values.data();
    for (unsigned int a = 0; a < cell.n_nodes; ++a)
      {
        to[a] = from[p[a]];
#pragma GCC unroll 4
        for (int i = 0; i < dim; ++i)
          to[(i + 1) * n_padded + a] = from[u[a] + i];
      }
    for (unsigned int c = 0; c <= dim; ++c)
      std::fill(to + c * n_padded + cell.n_nodes, to + (c + 1) * n_padded, 0.f);
  }

  template <int dim>
  void
  PointCoupling<dim>::add_pressures(const Cell &cell, float *y) const
  {
    gather(cell);
    const unsigned int n_padded = cell.n_padded;
    const unsigned int stride   = (dim + 1) * n_padded;
    const float       *N        = functions.data() + cell.functions;
    for (unsigned int q = 0; q < cell.n_points; ++q, N += stride)
      {
        Lanes of_p{}, of_u{};
        for (unsigned int a = 0; a < n_padded; a += lanes)
          {
            const float *value = values.data() + a;
            of_p += simd::load<Lanes>(N + a) * simd::load<Lanes>(value);
#pragma GCC unroll 4
            for (int i = 1; i <= dim; ++i)
              of_u += simd::load<Lanes>(N + i * n_padded + a) *
                      simd::load<Lanes>(value + i * n_padded);
          }
        const Lanes sum = of_u + stiffnesses[cell.first_point + q] * of_p;
        fluxes[q]       = simd::sum(sum);
      }
    const auto *p = pressures.data() + cell.first_node;
    for (unsigned int a = 0; a < cell.n_nodes; a += lanes)
      {
        Lanes force{};
        N = functions.data() + cell.functions + a;
        for (unsigned int q = 0; q < cell.n_points; ++q, N += stride)
          force += fluxes[q] * simd::load<Lanes>(N);
        const unsigned int n = std::min(lanes, cell.n_nodes - a);
        for (unsigned int lane = 0; lane < n; ++lane)
          y[p[a + lane]] += force[lane];
      }
  }

  // --- the diagonal ----------------------------------------------------------

  template <int dim>
  typename PointCoupling<dim>::VectorType
  PointCoupling<dim>::schur_diagonal(const VectorType &D_inverse) const
  {
    VectorType result(wide.get_partitioner());
    for (const Cell &cell : cells)
      add_schur_diagonal(cell, D_inverse, result);
    collect(result);
    for (unsigned int i = first_pressure; i < result.locally_owned_size(); ++i)
      result.local_element(i) -= diagonal.local_element(i);
    return result;
  }

  /// sum_a B_ab . D_a^{-1} B_ab - C_bb, of the patch's own B and C.
  template <int dim>
  void
  PointCoupling<dim>::add_schur_diagonal(const Cell       &cell,
                                         const VectorType &D_inverse,
                                         VectorType       &result) const
  {
    const unsigned int n_padded = cell.n_padded;
    const unsigned int stride   = (dim + 1) * n_padded;
    const float       *N        = functions.data() + cell.functions;
    const auto        *u        = displacements.data() + cell.first_node;
    const auto        *p        = pressures.data() + cell.first_node;
    for (unsigned int b = 0; b < cell.n_nodes; b += lanes)
      {
        Lanes sum{};
        for (unsigned int q = 0; q < cell.n_points; ++q)
          {
            const Lanes N_b = simd::load<Lanes>(N + q * stride + b);
            sum -= stiffnesses[cell.first_point + q] * N_b * N_b;
          }
        for (unsigned int a = 0; a < cell.n_nodes; ++a)
          {
            Lanes B[dim] = {};
            for (unsigned int q = 0; q < cell.n_points; ++q)
              {
                const float *row = N + q * stride;
                const Lanes  N_b = simd::load<Lanes>(row + b);
#pragma GCC unroll 4
                for (int i = 0; i < dim; ++i)
                  B[i] += row[(i + 1) * n_padded + a] * N_b;
              }
#pragma GCC unroll 4
            for (int i = 0; i < dim; ++i)
              sum += D_inverse.local_element(u[a] + i) * B[i] * B[i];
          }
        const unsigned int n = std::min(lanes, cell.n_nodes - b);
        for (unsigned int lane = 0; lane < n; ++lane)
          result.local_element(p[b + lane]) += sum[lane];
      }
  }

  template class PointCoupling<2>;
  template class PointCoupling<3>;
} // namespace selkie
