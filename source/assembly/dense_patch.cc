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
  DensePatch<dim>::reinit(const Patch<dim> &patch, const bool with_pressure)
  {
    n_nodes      = patch.n_nodes;
    n_padded     = patch.n_padded;
    n_components = with_pressure ? dim + 1 : dim;
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
  template <bool stress, bool source>
  void
  DensePatch<dim>::set_forces(const PatchState<dim> &state)
  {
    force.fill(0.);
    const auto &patch = *state.patch;
    for (unsigned int q = 0; q < patch.n_points; ++q)
      {
        const PointForm<dim> &form = state.forms[q];
        const double         *N    = state.table->N(patch, q);
        const double         *G    = N + n_padded;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int a = 0; a < n_padded; a += lanes)
            {
              double *r   = force.data() + i * n_padded + a;
              Lanes   sum = load(r);
              if constexpr (source)
                sum += form.source[i] * load(N + a);
              if constexpr (stress)
                for (unsigned int j = 0; j < dim; ++j)
                  sum += form.flux[i][j] * load(G + j * n_padded + a);
              simd::store(sum, r);
            }
      }
  }

  template <int dim>
  void
  DensePatch<dim>::add_volume_forces(const PatchState<dim> &state)
  {
    const auto &patch = *state.patch;
    for (unsigned int q = 0; q < patch.n_points; ++q)
      {
        const PointForm<dim> &form = state.forms[q];
        const double         *N    = state.table->N(patch, q);
        for (unsigned int a = 0; a < n_padded; a += lanes)
          {
            double     *r = force.data() + dim * n_padded + a;
            const Lanes sum =
              load(r) + load(N + a) * (form.p_source +
                                       form.lumped * (load(p.data() + a) -
                                                      state.kinematics[q].p));
            simd::store(sum, r);
          }
      }
  }

  template <int dim>
  void
  DensePatch<dim>::add_mean_forces(const PatchState<dim> &state)
  {
    const auto g = mean_vector(state, state.mean.gradient);
    for (unsigned int i = 0; i < g.size(); ++i)
      force[i] += state.mean.force * g[i];
  }

  template <int dim>
  std::vector<typename DensePatch<dim>::Step>
  DensePatch<dim>::force_steps(const TermUse &use)
  {
    std::vector<Step> steps;
    if (use.stress || use.source || use.volume)
      steps.push_back(!use.source   ? &DensePatch::set_forces<true, false>
                      : !use.stress ? &DensePatch::set_forces<false, true>
                                    : &DensePatch::set_forces<true, true>);
    if (use.volume)
      steps.push_back(&DensePatch::add_volume_forces);
    if (use.mean)
      steps.push_back(&DensePatch::add_mean_forces);
    return steps;
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
          double      *row =
            block.data() + std::size_t(a * n_components + i) * row_length();
          for (unsigned int k = 0; k < dim; ++k)
            for (unsigned int b = 0; b < n_padded; ++b)
              row[dim * b + k] += (E_a + s * g_a) * g[k * n_padded + b] +
                                  g_a * E[k * n_padded + b];
        }
  }

  namespace
  {
    /// The parts of one point's block row that depend on node a only: the
    /// factors of G_l and of N_b in the displacement block, of N_b in K_up, of
    /// G_l in K_pu and of N_b in K_pp.
    template <int dim>
    struct RowFactors
    {
      double G[dim][dim][dim];
      double mass;
      double up[dim], pu[dim][dim], pp;
    };

    template <int dim, bool pressure>
    void
    row_factors(const PointForm<dim> &form,
                const double         *G, // G_a, strided
                const unsigned int    stride,
                const double          N_a,
                RowFactors<dim>      &row)
    {
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int l = 0; l < dim; ++l)
            {
              double sum = 0.;
              for (unsigned int j = 0; j < dim; ++j)
                sum += form.stiffness[j][l][i][k] * G[j * stride];
              row.G[i][k][l] = sum;
            }
      row.mass = form.mass * N_a;
      if constexpr (pressure)
        {
          for (unsigned int i = 0; i < dim; ++i)
            {
              row.up[i] = 0.;
              for (unsigned int j = 0; j < dim; ++j)
                {
                  row.up[i] += form.coupling[i][j] * G[j * stride];
                  row.pu[i][j] = N_a * form.coupling[i][j];
                }
            }
          row.pp = N_a * (form.p_stiffness - form.lumped);
        }
    }

    /// The part of a block row for some nodes b: what row component i takes
    /// from column component k. Loops over components must be unrolled for it
    /// to stay in registers.
    template <int n_components>
    struct RowPart
    {
      Lanes sum[n_components][n_components];

      RowPart()
      {
#pragma GCC unroll 4
        for (int i = 0; i < n_components; ++i)
#pragma GCC unroll 4
          for (int k = 0; k < n_components; ++k)
            sum[i][k] = Lanes{};
      }

      /// Adds what one point gives.
      /// @param N values, n_padded from each other those of N_b and of G_b
      template <int dim, bool mass>
      void
      add(const RowFactors<dim> &row,
          const double          *N,
          const unsigned int     n_padded)
      {
        const Lanes N_b = load(N);
        Lanes       G_b[dim];
#pragma GCC unroll 4
        for (int l = 0; l < dim; ++l)
          G_b[l] = load(N + (l + 1) * n_padded);
#pragma GCC unroll 4
        for (int i = 0; i < dim; ++i)
#pragma GCC unroll 4
          for (int k = 0; k < dim; ++k)
            {
              if (mass && i == k)
                sum[i][k] += row.mass * N_b;
#pragma GCC unroll 4
              for (int l = 0; l < dim; ++l)
                sum[i][k] += row.G[i][k][l] * G_b[l];
            }
        if constexpr (n_components > dim)
          {
#pragma GCC unroll 4
            for (int i = 0; i < dim; ++i)
              {
                sum[i][dim] += row.up[i] * N_b;
#pragma GCC unroll 4
                for (int l = 0; l < dim; ++l)
                  sum[dim][i] += row.pu[i][l] * G_b[l];
              }
            sum[dim][dim] += row.pp * N_b;
          }
      }

      /// @param row the first of the node's rows in the block
      template <int dim>
      void
      store(double            *row,
            const unsigned int b,
            const unsigned int n_padded) const
      {
#pragma GCC unroll 4
        for (int i = 0; i < n_components; ++i, row += n_components * n_padded)
          {
            double *to = row + dim * b;
            if constexpr (dim == 2)
              {
                Lanes first, second;
                simd::interleave(sum[i][0], sum[i][1], first, second);
                simd::store(first, to);
                simd::store(second, to + lanes);
              }
            else
              for (unsigned int lane = 0; lane < lanes; ++lane)
                for (int d = 0; d < dim; ++d)
                  to[lane * dim + d] = sum[i][d][lane];
            if constexpr (n_components > dim)
              simd::store(sum[i][dim], row + dim * n_padded + b);
          }
      }
    };

    /// All rows of the block: for each node a, the products with the other
    /// nodes are summed over the points in registers and stored once.
    template <int dim, int n_components, bool mass>
    void
    fill_block(const PatchState<dim> &state,
               const unsigned int     n_padded,
               double                *block)
    {
      const auto                               &patch = *state.patch;
      thread_local std::vector<RowFactors<dim>> rows;
      rows.resize(patch.n_points);
      const double      *N_0 = state.table->N(patch, 0); // of the first point
      const unsigned int stride = (dim + 1) * n_padded;  // to the next
      for (unsigned int a = 0; a < patch.n_nodes; ++a)
        {
          for (unsigned int q = 0; q < patch.n_points; ++q)
            {
              const double *N = N_0 + q * stride;
              row_factors<dim, (n_components > dim)>(
                state.forms[q], N + n_padded + a, n_padded, N[a], rows[q]);
            }
          double *row =
            block + std::size_t(a) * n_components * n_components * n_padded;
          for (unsigned int b = 0; b < n_padded; b += lanes)
            {
              RowPart<n_components> part;
              const double         *N = N_0 + b;
              for (unsigned int q = 0; q < patch.n_points; ++q, N += stride)
                part.template add<dim, mass>(rows[q], N, n_padded);
              part.template store<dim>(row, b, n_padded);
            }
          if constexpr (n_components > dim)
            for (unsigned int q = 0; q < patch.n_points; ++q)
              row[(dim * n_components + dim) * n_padded + a] +=
                state.forms[q].lumped * N_0[q * stride + a];
        }
    }
  } // namespace

  template <int dim>
  template <int n_components, bool mass>
  void
  DensePatch<dim>::set_block(const PatchState<dim> &state)
  {
    block.resize_fast(std::size_t(n_nodes) * n_components * n_components *
                      n_padded);
    fill_block<dim, n_components, mass>(state, n_padded, block.data());
  }

  template <int dim>
  std::vector<typename DensePatch<dim>::Step>
  DensePatch<dim>::block_steps(const TermUse &use)
  {
    std::vector<Step> steps;
    if (use.volume)
      steps.push_back(use.mass ? &DensePatch::set_block<dim + 1, true>
                               : &DensePatch::set_block<dim + 1, false>);
    else if (use.stress || use.mass)
      steps.push_back(use.mass ? &DensePatch::set_block<dim, true>
                               : &DensePatch::set_block<dim, false>);
    if (use.mean)
      steps.push_back(&DensePatch::add_mean_block);
    return steps;
  }

  template class DensePatch<2>;
  template class DensePatch<3>;
} // namespace selkie
