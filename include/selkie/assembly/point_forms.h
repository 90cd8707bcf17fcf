#pragma once

#include <selkie/shape/simd.h>

#include <algorithm>

namespace selkie
{
  /// What the terms leave at as many points as there are lanes (PointForm).
  template <int dim, typename Lanes>
  struct PointForms
  {
    Lanes mass                          = {};
    Lanes stiffness[dim][dim][dim][dim] = {}; ///< from (k, l) to (i, j)
  };

  /// The same of the pressure, where there is one.
  template <int dim, typename Lanes>
  struct PressureForms
  {
    Lanes coupling[dim][dim] = {};
    Lanes stiffness          = {}; ///< without what is lumped
  };

  /**
   * Forms applied to functions in the points of one patch; see PointTangent.
   * Points are in the lanes while forms are applied, nodes before and after.
   *
   * @tparam mass whether PointForms::mass may differ from zero
   * @tparam pressure whether the nodes have one
   */
  template <int dim, typename Number, bool mass, bool pressure>
  class PatchProduct
  {
  public:
    using Lanes                         = simd::NativeOf<Number>;
    static constexpr unsigned int lanes = sizeof(Lanes) / sizeof(Number);

    /// Numbers that a point's fluxes take.
    static constexpr unsigned int n_fluxes =
      dim * dim + (mass ? dim : 0) + (pressure ? 1 : 0);

    unsigned int  n_points, n_nodes, n_padded;
    const Number *N, *G;  ///< of the first point
    std::size_t   stride; ///< to the next point

    const PointForms<dim, Lanes>    *forms;
    const PressureForms<dim, Lanes> *pressure_forms;

    const Number *values; ///< component-major, the pressures last
    Number       *fluxes; ///< room for n_fluxes a point (in full lanes)

    /// Values at the nodes to fluxes in the points.
    void
    set_fluxes() const
    {
      const Number *N_q = N, *G_q = G;
      Number       *flux = fluxes;
      for (unsigned int first = 0; first < n_points; first += lanes)
        {
          const unsigned int n = std::min(lanes, n_points - first);
          Sample             in, out;
          for (unsigned int lane = 0; lane < n; ++lane)
            {
              interpolate(N_q, G_q, lane, in);
              N_q += stride;
              G_q += stride;
            }
          apply(first / lanes, in, out);
          for (unsigned int lane = 0; lane < n; ++lane)
            store(out, lane, flux);
        }
    }

    /// Fluxes to forces at the nodes: calls add_u(node, i, force) and
    /// add_p(node, force).
    template <typename AddU, typename AddP>
    void
    integrate(const AddU &add_u, const AddP &add_p) const
    {
      for (unsigned int a = 0; a < n_nodes; a += lanes)
        {
          const Number *N_q = N + a, *G_q = G + a;
          const Number *flux       = fluxes;
          Lanes         force[dim] = {}, force_p = {};
          for (unsigned int q = 0; q < n_points;
               ++q, N_q += stride, G_q += stride)
            {
              if constexpr (mass)
                {
                  add_row(flux, N_q, force);
                  flux += dim;
                }
#pragma GCC unroll 4
              for (int j = 0; j < dim; ++j, flux += dim)
                add_row(flux, G_q + j * n_padded, force);
              if constexpr (pressure)
                force_p += *flux++ * simd::load<Lanes>(N_q);
            }
          const unsigned int n = std::min(lanes, n_nodes - a);
          for (unsigned int lane = 0; lane < n; ++lane)
            {
#pragma GCC unroll 4
              for (int i = 0; i < dim; ++i)
                add_u(a + lane, i, force[i][lane]);
              if constexpr (pressure)
                add_p(a + lane, force_p[lane]);
            }
        }
    }

  private:
    /// Of as many points as there are lanes: fields, or fluxes.
    struct Sample
    {
      Lanes u[dim]             = {};
      Lanes gradient[dim][dim] = {};
      Lanes p                  = {};
    };

    /// The fields in one point, into its lane.
    void
    interpolate(const Number      *N_q,
                const Number      *G_q,
                const unsigned int lane,
                Sample            &in) const
    {
      Sample sum;
      for (unsigned int a = 0; a < n_padded; a += lanes)
        {
          Lanes N_a, G_a[dim];
          if constexpr (mass || pressure)
            N_a = simd::load<Lanes>(N_q + a);
#pragma GCC unroll 4
          for (int j = 0; j < dim; ++j)
            G_a[j] = simd::load<Lanes>(G_q + j * n_padded + a);
#pragma GCC unroll 4
          for (int i = 0; i < dim; ++i)
            {
              const Lanes u = simd::load<Lanes>(values + i * n_padded + a);
              if constexpr (mass)
                sum.u[i] += u * N_a;
#pragma GCC unroll 4
              for (int j = 0; j < dim; ++j)
                sum.gradient[i][j] += u * G_a[j];
            }
          if constexpr (pressure)
            sum.p += simd::load<Lanes>(values + dim * n_padded + a) * N_a;
        }
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
        {
          if constexpr (mass)
            in.u[i][lane] = simd::sum(sum.u[i]);
#pragma GCC unroll 4
          for (int j = 0; j < dim; ++j)
            in.gradient[i][j][lane] = simd::sum(sum.gradient[i][j]);
        }
      if constexpr (pressure)
        in.p[lane] = simd::sum(sum.p);
    }

    void
    apply(const unsigned int group, const Sample &in, Sample &out) const
    {
      const auto &form = forms[group];
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
        {
          if constexpr (mass)
            out.u[i] = form.mass * in.u[i];
#pragma GCC unroll 4
          for (int j = 0; j < dim; ++j)
            {
              Lanes sum{};
#pragma GCC unroll 4
              for (int k = 0; k < dim; ++k)
#pragma GCC unroll 4
                for (int l = 0; l < dim; ++l)
                  sum += form.stiffness[i][j][k][l] * in.gradient[k][l];
              out.gradient[i][j] = sum;
            }
        }
      if constexpr (pressure)
        {
          const auto &with_p = pressure_forms[group];
          out.p              = with_p.stiffness * in.p;
#pragma GCC unroll 4
          for (int i = 0; i < dim; ++i)
#pragma GCC unroll 4
            for (int j = 0; j < dim; ++j)
              {
                out.gradient[i][j] += with_p.coupling[i][j] * in.p;
                out.p += with_p.coupling[i][j] * in.gradient[i][j];
              }
        }
    }

    static void
    store(const Sample &out, const unsigned int lane, Number *&flux)
    {
      if constexpr (mass)
#pragma GCC unroll 4
        for (int i = 0; i < dim; ++i)
          *flux++ = out.u[i][lane];
#pragma GCC unroll 4
      for (int j = 0; j < dim; ++j)
#pragma GCC unroll 4
        for (int i = 0; i < dim; ++i)
          *flux++ = out.gradient[i][j][lane];
      if constexpr (pressure)
        *flux++ = out.p[lane];
    }

    static void
    add_row(const Number *flux, const Number *row, Lanes (&force)[dim])
    {
      const Lanes functions = simd::load<Lanes>(row);
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
        force[i] += flux[i] * functions;
    }
  };
} // namespace selkie
