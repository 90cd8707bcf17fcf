#include <selkie/assembly/hat_patch.h>
#include <selkie/shape/lme.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/quadrature_lib.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The mean of what the points of a patch have, for one of n points.
    template <int dim>
    PointForm<dim>
    share(const std::vector<PointForm<dim>> &forms, const unsigned int n)
    {
      PointForm<dim> sum;
      for (const auto &form : forms)
        {
          for (unsigned int j = 0; j < dim; ++j)
            for (unsigned int l = 0; l < dim; ++l)
              sum.stiffness[j][l] += form.stiffness[j][l] / n;
          sum.mass += form.mass / n;
          sum.coupling += form.coupling / n;
          sum.p_stiffness += form.p_stiffness / n;
          sum.lumped += form.lumped / n;
        }
      return sum;
    }

    template <int dim>
    std::vector<Tensor<2, dim>>
    share(const std::vector<Tensor<2, dim>> &tensors, const unsigned int n)
    {
      Tensor<2, dim> sum;
      for (const auto &tensor : tensors)
        sum += tensor / n;
      return std::vector<Tensor<2, dim>>(tensors.empty() ? 0 : n, sum);
    }
  } // namespace


  template <int dim>
  const PatchState<dim> &
  HatPatch<dim>::of(const PatchState<dim> &state, const NodeCloud<dim> &cloud)
  {
    if (state.patch->contact) // the same with any functions
      return state;
    constexpr unsigned int n    = GeometryInfo<dim>::vertices_per_cell;
    const auto            &cell = state.patch->cell;
    const unsigned int     node = state.table->nodes[state.patch->first_node];
    const auto             corners = cloud.corners(cell, cloud.layer(node));
    table.patches.assign(1, *state.patch);
    Patch<dim> &hats = table.patches[0];
    hats.first_node = hats.first_point = hats.data = 0;
    hats.n_points = hats.n_nodes = n;
    hats.n_padded                = lme_padded(n);
    table.nodes.assign(corners.begin(), corners.end());
    const Tensor<1, dim> cell_size = cell->vertex(n - 1) - cell->vertex(0);
    if (cell_size != size)
      set_functions(cell_size);

    spread.table = &table;
    spread.patch = &hats;
    spread.time  = state.time;
    spread.forms.assign(n, share(state.forms, n));
    spread.mean.gradient  = share(state.mean.gradient, n);
    spread.mean.coupling  = share(state.mean.coupling, n);
    spread.mean.stiffness = state.mean.stiffness;
    return spread;
  }


  template <int dim>
  void
  HatPatch<dim>::set_functions(const Tensor<1, dim> &cell_size)
  {
    constexpr unsigned int n     = GeometryInfo<dim>::vertices_per_cell;
    const unsigned int     width = lme_padded(n);
    const QGauss<dim>      gauss(2);
    size = cell_size;
    table.data.resize_fast(n * (dim + 1) * width);
    table.data.fill(0.);
    for (unsigned int q = 0; q < n; ++q)
      for (unsigned int a = 0; a < n; ++a)
        {
          double              *N = table.data.data() + q * (dim + 1) * width;
          const Point<dim>    &x = gauss.point(q);
          const Tensor<1, dim> slope =
            GeometryInfo<dim>::d_linear_shape_function_gradient(x, a);
          N[a] = GeometryInfo<dim>::d_linear_shape_function(x, a);
          for (unsigned int d = 0; d < dim; ++d)
            N[(d + 1) * width + a] = slope[d] / size[d];
        }
  }

  template class HatPatch<2>;
  template class HatPatch<3>;
} // namespace selkie
