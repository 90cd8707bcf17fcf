#include <selkie/assembly/dense_patch.h>
#include <selkie/shape/lme.h>
#include <selkie/shape/simd.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    using Lanes                  = simd::Native;
    constexpr unsigned int lanes = simd::n_lanes<Lanes>;
    static_assert(lme_padding % lanes == 0,
                  "node lists must be padded to full lanes");

    Lanes
    load(const double *from)
    {
      return simd::load<Lanes>(from);
    }
  } // namespace

  template <int dim>
  void
  DensePatch<dim>::reinit(const Patch<dim> &patch)
  {
    n_nodes      = patch.n_nodes;
    n_padded     = patch.n_padded;
    n_components = patch.fluid ? dim + 1 : dim;
    for (auto *values : {&du, &velocity, &acceleration})
      values->resize_fast(dim * n_padded);
    p.resize_fast(n_padded);
    force.resize_fast(n_components * n_padded);
  }

  template <int dim>
  double
  DensePatch<dim>::value(const double *values, const double *N) const
  {
    Lanes sum{};
    for (unsigned int a = 0; a < n_padded; a += lanes)
      sum += load(values + a) * load(N + a);
    return simd::sum(sum);
  }

  template <int dim>
  Tensor<2, dim>
  DensePatch<dim>::gradient(const AlignedVector<double> &values,
                            const double                *G) const
  {
    Tensor<2, dim> result;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        result[i][j] = value(values.data() + i * n_padded, G + j * n_padded);
    return result;
  }

  template <int dim>
  void
  DensePatch<dim>::integrate_forces(const PatchState<dim> &state)
  {
    force.fill(0.);
    const auto &patch = *state.patch;
    for (unsigned int q = 0; q < patch.n_points; ++q)
      {
        const PointForm<dim> &form = state.forms[q];
        const double         *N    = state.table->N(patch, q);
        const double         *G    = N + n_padded;
        for (unsigned int a = 0; a < n_padded; a += lanes)
          {
            const Lanes N_a = load(N + a);
            for (unsigned int i = 0; i < dim; ++i)
              {
                double *r   = force.data() + i * n_padded + a;
                Lanes   sum = load(r) + form.source[i] * N_a;
                for (unsigned int j = 0; j < dim; ++j)
                  sum += form.flux[i][j] * load(G + j * n_padded + a);
                simd::store(sum, r);
              }
            if (patch.fluid && patch.integration)
              {
                double     *r = force.data() + dim * n_padded + a;
                const Lanes sum =
                  load(r) +
                  N_a * (form.p_source + form.lumped * (load(p.data() + a) -
                                                        state.kinematics[q].p));
                simd::store(sum, r);
              }
          }
      }
    if (!state.mean.gradient.empty())
      {
        const auto g = mean_vector(state, state.mean.gradient);
        for (unsigned int i = 0; i < g.size(); ++i)
          force[i] += state.mean.force * g[i];
      }
  }

  template <int dim>
  AlignedVector<double>
  DensePatch<dim>::mean_vector(const PatchState<dim>             &state,
                               const std::vector<Tensor<2, dim>> &tensors) const
  {
    AlignedVector<double> sum(dim * n_padded);
    for (unsigned int q = 0; q < state.patch->n_points; ++q)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          {
            const double *G = state.table->gradient(*state.patch, q, j);
            for (unsigned int a = 0; a < n_padded; ++a)
              sum[i * n_padded + a] += tensors[q][i][j] * G[a];
          }
    return sum;
  }

  template <int dim>
  void
  DensePatch<dim>::add_mean_block(const PatchState<dim> &state)
  {
    const auto   g = mean_vector(state, state.mean.gradient);
    const auto   E = mean_vector(state, state.mean.coupling);
    const double s = state.mean.stiffness;
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int i = 0; i < dim; ++i)
        {
          const double g_a = g[i * n_padded + a], E_a = E[i * n_padded + a];
          double      *row = block.data() + std::size_t(a * n_components + i) *
                                         n_components * n_padded;
          for (unsigned int b = 0; b < dim * n_padded; ++b)
            row[b] += (E_a + s * g_a) * g[b] + g_a * E[b];
        }
  }

  namespace
  {
    /// The parts of one point's block row that depend on node a only: for each
    /// pair of components, the factors of G_l (l < dim) and of N_b.
    template <int dim, int n_components>
    struct RowFactors
    {
      double G[n_components][n_components][dim];
      double N[n_components][n_components];
    };

    template <int dim, int n_components>
    void
    row_factors(const PointForm<dim>          &form,
                const double                  *G, // G_a, strided
                const unsigned int             stride,
                const double                   N_a,
                RowFactors<dim, n_components> &row)
    {
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          {
            for (unsigned int l = 0; l < dim; ++l)
              {
                double sum = 0.;
                for (unsigned int j = 0; j < dim; ++j)
                  sum += form.stiffness[j][l][i][k] * G[j * stride];
                row.G[i][k][l] = sum;
              }
            row.N[i][k] = (i == k) ? form.mass * N_a : 0.;
          }
      if constexpr (n_components > dim)
        {
          for (unsigned int i = 0; i < dim; ++i)
            {
              double up = 0.;
              for (unsigned int j = 0; j < dim; ++j)
                up += form.coupling[i][j] * G[j * stride];
              for (unsigned int l = 0; l < dim; ++l)
                {
                  row.G[i][dim][l] = 0.;
                  row.G[dim][i][l] = N_a * form.coupling[i][l];
                }
              row.N[i][dim] = up;
              row.N[dim][i] = 0.;
            }
          for (unsigned int l = 0; l < dim; ++l)
            row.G[dim][dim][l] = 0.;
          row.N[dim][dim] = N_a * (form.p_stiffness - form.lumped);
        }
    }

    /// All rows of the block: for each node a, the products with the other
    /// nodes are summed over the points in registers and stored once.
    template <int dim, int n_components>
    void
    fill_block(const PatchState<dim> &state,
               const unsigned int     n_padded,
               double                *block)
    {
      const auto &patch = *state.patch;
      thread_local std::vector<RowFactors<dim, n_components>> rows;
      rows.resize(patch.n_points);
      for (unsigned int a = 0; a < patch.n_nodes; ++a)
        {
          double lumped = 0.;
          for (unsigned int q = 0; q < patch.n_points; ++q)
            {
              const double *N = state.table->N(patch, q);
              row_factors<dim, n_components>(
                state.forms[q], N + n_padded + a, n_padded, N[a], rows[q]);
              lumped += state.forms[q].lumped * N[a];
            }
          double *row =
            block + std::size_t(a) * n_components * n_components * n_padded;
          for (unsigned int b = 0; b < n_padded; b += lanes)
            {
              Lanes sum[n_components][n_components] = {};
              for (unsigned int q = 0; q < patch.n_points; ++q)
                {
                  const double *N   = state.table->N(patch, q);
                  const Lanes   N_b = load(N + b);
                  Lanes         G_b[dim];
                  for (unsigned int l = 0; l < dim; ++l)
                    G_b[l] = load(N + (l + 1) * n_padded + b);
                  for (unsigned int i = 0; i < n_components; ++i)
                    for (unsigned int k = 0; k < n_components; ++k)
                      {
                        sum[i][k] += rows[q].N[i][k] * N_b;
                        for (unsigned int l = 0; l < dim; ++l)
                          sum[i][k] += rows[q].G[i][k][l] * G_b[l];
                      }
                }
              for (unsigned int i = 0; i < n_components; ++i)
                for (unsigned int k = 0; k < n_components; ++k)
                  simd::store(sum[i][k],
                              row + (i * n_components + k) * n_padded + b);
            }
          if constexpr (n_components > dim)
            row[(dim * n_components + dim) * n_padded + a] += lumped;
        }
    }
  } // namespace

  template <int dim>
  void
  DensePatch<dim>::integrate_block(const PatchState<dim> &state)
  {
    block.resize_fast(std::size_t(n_nodes) * n_components * n_components *
                      n_padded);
    if (n_components > dim)
      fill_block<dim, dim + 1>(state, n_padded, block.data());
    else
      fill_block<dim, dim>(state, n_padded, block.data());
    if (!state.mean.gradient.empty())
      add_mean_block(state);
  }

  template class DensePatch<2>;
  template class DensePatch<3>;
} // namespace selkie
