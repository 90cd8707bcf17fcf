#include <selkie/mesh/cell_locator.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace selkie
{
  template <int dim>
  CellLocator<dim>::CellLocator(const Triangulation &mesh)
    : mesh(mesh)
    , smallest_coarse_extent(std::numeric_limits<double>::max())
    , finest_level(mesh.n_global_levels() - 1)
  {
    constexpr unsigned int last        = (1u << dim) - 1;
    const unsigned int     n           = mesh.n_cells(0);
    const auto             coarse_cell = [&](const unsigned int i) {
      return typename Triangulation::cell_iterator(&mesh, 0, i);
    };
    low                           = coarse_cell(0)->vertex(0);
    high                          = coarse_cell(n - 1)->vertex(last);
    unsigned int           stride = 1;
    dealii::Tensor<1, dim> extent = coarse_cell(0)->vertex(last) - low;
    for (unsigned int d = 0; d < dim; ++d)
      {
        cells[d] = std::lround((high[d] - low[d]) / extent[d]);
        smallest_coarse_extent =
          std::min(smallest_coarse_extent, (high[d] - low[d]) / cells[d]);
        stride *= cells[d];
      }
    bool is_lattice = stride == n;
    for (unsigned int i = 0; i < n && is_lattice; ++i)
      for (unsigned int d = 0, rest = i; d < dim; rest /= cells[d], ++d)
        is_lattice &=
          std::abs(coarse_cell(i)->vertex(0)[d] - low[d] -
                   (rest % cells[d]) * extent[d]) < 1e-6 * extent[d];
    AssertThrow(is_lattice,
                dealii::ExcMessage("The coarse mesh is not a lattice."));
  }


  template <int dim>
  typename CellLocator<dim>::Location
  CellLocator<dim>::locate(const dealii::Point<dim> &x) const
  {
    Location     result;
    unsigned int index = 0;
    for (unsigned int d = 0, stride = 1; d < dim; stride *= cells[d], ++d)
      {
        const double s = (x[d] - low[d]) / (high[d] - low[d]) * cells[d];
        const double i = std::clamp(std::floor(s), 0., cells[d] - 1.);
        index += stride * static_cast<unsigned int>(i);
        result.reference[d] = s - i;
      }
    typename Triangulation::cell_iterator cell(&mesh, 0, index);
    while (cell->has_children())
      {
        unsigned int child = 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            double &s = result.reference[d]; // doubling, -1: without round-off
            s *= 2.;
            if (s >= 1.)
              {
                child |= 1u << d;
                s -= 1.;
              }
          }
        cell = cell->child(child);
      }
    result.cell = cell;
    return result;
  }


  template <int dim>
  double
  CellLocator<dim>::n_finest(const unsigned int direction) const
  {
    return std::ldexp(cells[direction], finest_level);
  }


  template <int dim>
  dealii::Point<dim>
  CellLocator<dim>::inside_cell(const dealii::Point<dim> &x) const
  {
    dealii::Point<dim> center;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double extent = high[d] - low[d];
        const double s = (x[d] - low[d]) / extent * cells[d]; // as locate()
        const double i = std::clamp(std::floor(std::ldexp(s, finest_level)),
                                    0.,
                                    n_finest(d) - 1.);
        center[d]      = low[d] + (i + 0.5) / n_finest(d) * extent;
      }
    return center;
  }


  template <int dim>
  typename CellLocator<dim>::Key
  CellLocator<dim>::key(const dealii::Point<dim> &vertex) const
  {
    Key result;
    for (unsigned int d = 0; d < dim; ++d)
      {
        result[d] =
          std::llround((vertex[d] - low[d]) / (high[d] - low[d]) * n_finest(d));
      }
    return result;
  }


  template <int dim>
  dealii::Point<dim>
  CellLocator<dim>::position(const Key &key) const
  {
    dealii::Point<dim> x;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double s = static_cast<double>(key[d]) / n_finest(d);
        x[d]           = low[d] * (1. - s) + high[d] * s; // exact on the walls
      }
    return x;
  }


  template <int dim>
  double
  CellLocator<dim>::spacing(const int level) const
  {
    return std::ldexp(smallest_coarse_extent, -level);
  }


  template <int dim>
  double
  CellLocator<dim>::smallest_spacing() const
  {
    return spacing(finest_level);
  }


  template class CellLocator<2>;
  template class CellLocator<3>;
} // namespace selkie
