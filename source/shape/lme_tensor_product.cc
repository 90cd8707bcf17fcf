#include <selkie/shape/lme_tensor_product.h>
#include <selkie/shape/simd.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using dealii::Point;
  using dealii::Tensor;

  namespace
  {
    using V    = simd::Native;
    using Dims = simd::Four; // the lanes are the space directions
    constexpr unsigned int lanes      = simd::n_lanes<V>;
    constexpr unsigned int max_line   = 32;
    constexpr double       max_gamma  = 500.; // gamma (n-1)^2
    constexpr unsigned int max_steps  = 12;
    constexpr double       small_step = 0.01; // exponents: vexp_small suffices
    constexpr double       accurate_step = 1e-9; // nothing left to gain
    constexpr double       wall_variance = 1e-4; // less than this near a wall

    /// The one-dimensional functions along the lines of a box, node by node.
    struct Lines
    {
      alignas(64) double N[3][max_line];
      alignas(64) double grad[3][max_line];
    };

    /**
     * All directions at once, in units of h: t is the distance from node 0 and
     * nu = lambda h. The weight of node i is exp(-gamma (t-i)^2 + nu (t-i)),
     * relative to that of node 0.
     */
    struct LineKernel
    {
      Dims         t, nu, gamma, decay, last;
      unsigned int n_nodes; // of the longest line

      Dims ratio;                    // weight of node 1 / weight of node 0
      Dims Z, r, variance, skewness; // the sums (L11)

      /// Start at nu.
      void
      evaluate()
      {
        ratio = simd::vexp(Dims(gamma * (t + t - 1.) - nu));
        accumulate();
      }

      void
      advance(const Dims &step, const bool is_small)
      {
        nu += step;
        const Dims minus = -step;
        ratio *= is_small ? simd::vexp_small(minus) : simd::vexp(minus);
        accumulate();
      }

      void
      accumulate()
      {
        Dims third = {};
        Z = r = variance = Dims{};
        for_each_node([&](unsigned int, const Dims &w, const Dims &u) {
          const Dims wu = w * u, wuu = wu * u;
          Z += w;
          r += wu;
          variance += wuu;
          third += wuu * u;
        });
        const Dims factor = 1. / Z, second = variance * factor;
        r *= factor;
        variance = second - r * r;
        skewness = third * factor - r * (2. * variance + second);
      }

      /// Call f(i, weight, t - i) for the nodes, by the recurrence (L12).
      template <class Function>
      void
      for_each_node(const Function &f) const
      {
        Dims w = simd::all<Dims>(1.), rho = ratio, u = t;
#pragma GCC unroll 1
        for (unsigned int i = 0; i < n_nodes; ++i)
          {
            // Shorter lines have no such node.
            const Dims weight = (last < double(i) ? Dims{} : w);
            f(i, weight, u);
            w *= rho;
            rho *= decay;
            u -= 1.;
          }
      }
    };

    inline double
    largest_magnitude(const Dims &v)
    {
      return simd::largest_lane(simd::max(v, Dims(-v)));
    }

    /// Halley's iteration (L13) in all directions; the number of steps, or 0 if
    /// it does not converge quickly or a wall is near.
    inline __attribute__((always_inline)) unsigned int
    solve(LineKernel &lines, const double tolerance)
    {
      lines.evaluate();
      for (unsigned int i = 1; i <= max_steps; ++i)
        {
          const Dims &r = lines.r, &H = lines.variance;
          if (!(simd::largest_lane(Dims(-H)) < -wall_variance))
            return 0;
          const Dims   step   = -2. * r * H / (2. * H * H - r * lines.skewness);
          const double length = largest_magnitude(step);
          if (length < accurate_step && largest_magnitude(r) < tolerance)
            return i;
          lines.advance(simd::min(simd::all<Dims>(4.),
                                  simd::max(simd::all<Dims>(-4.), step)),
                        length * lines.n_nodes < small_step);
        }
      return 0;
    }

    /// The kernel for the point; unused lanes get two nodes and a point
    /// halfway.
    template <int dim>
    LineKernel
    make_kernel(const LmeNodes<dim>  &nodes,
                const Point<dim>     &x,
                const Tensor<1, dim> &lambda)
    {
      const auto last_node = [&](const unsigned int d) {
        return nodes.box_size[d] - 1.;
      };
      const Tensor<1, dim>   t  = (x - nodes.box_origin) / nodes.h;
      const Tensor<1, dim>   nu = lambda * nodes.h;
      constexpr unsigned int z  = dim - 1;
      LineKernel             lines;
      lines.t  = Dims{t[0], t[1], dim == 3 ? t[z] : .5, .5};
      lines.nu = Dims{nu[0], nu[1], dim == 3 ? nu[z] : 0., 0.};
      lines.last =
        Dims{last_node(0), last_node(1), dim == 3 ? last_node(z) : 1., 1.};
      lines.gamma = simd::all<Dims>(nodes.beta[0] * nodes.h * nodes.h);
      lines.decay = simd::all<Dims>(nodes.box_decay);
      lines.n_nodes =
        *std::max_element(nodes.box_size.begin(), nodes.box_size.end());
      return lines;
    }

    /// Component d of consecutive Dims. Vectors are put together in registers
    /// here and in make_kernel(): to load what was just stored in pieces
    /// stalls.
    template <class Vector>
    inline Vector
    column(const Dims *from, const unsigned int d)
    {
      Vector v = {};
      for (unsigned int l = 0; l < simd::n_lanes<Vector>; ++l)
        v[l] = from[l][d];
      return v;
    }

    /// One-dimensional functions and gradients (L6) from the converged weights.
    template <int dim>
    void
    fill(const LineKernel &lines, const double h, Lines &result)
    {
      const Dims factor = 1. / lines.Z, slope = (-1. / h) / lines.variance;
      const unsigned int n_padded = lme_padded(lines.n_nodes);
      Dims               N[max_line], grad[max_line];
      lines.for_each_node([&](const unsigned int i, const Dims &w, Dims u) {
        N[i]    = w * factor;
        grad[i] = N[i] * u * slope;
      });
      // store_row computes with whole vectors: rubbish there would be slow.
      for (unsigned int i = lines.n_nodes; i < n_padded; ++i)
        N[i] = grad[i] = Dims{};
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int i = 0; i < n_padded; i += lanes)
          {
            simd::store(column<V>(N + i, d), result.N[d] + i);
            simd::store(column<V>(grad + i, d), result.grad[d] + i);
          }
    }

    /// to[i] = factor * line[i], 0 <= i < n; rubbish may follow up to room.
    inline void
    store_row(const double       factor,
              const double      *line,
              const unsigned int n,
              const unsigned int room,
              double            *to)
    {
      for (unsigned int i = 0; i < n; i += lanes)
        {
          const V row = factor * simd::load<V>(line + i);
          if (i + lanes <= room)
            simd::store(row, to + i);
          else
            for (unsigned int l = 0; i + l < n; ++l)
              to[i + l] = row[l];
        }
    }

    /// The products (L10), row after row in x direction.
    template <int dim>
    void
    store_products(const LmeNodes<dim> &nodes,
                   const Lines         &lines,
                   double              *N,
                   double              *grad)
    {
      const auto        &size     = nodes.box_size;
      const unsigned int n_planes = (dim == 3 ? size[dim - 1] : 1);
      double *grad_y = grad + nodes.n_padded, *grad_z = grad_y + nodes.n_padded;
      for (unsigned int k = 0, row = 0; k < n_planes; ++k)
        {
          const double N_z = (dim == 3 ? lines.N[2][k] : 1.);
          for (unsigned int j = 0; j < size[1]; ++j, row += size[0])
            {
              const auto store =
                [&](const double factor, const double *line, double *to) {
                  store_row(
                    factor, line, size[0], nodes.n_padded - row, to + row);
                };
              const double N_yz = lines.N[1][j] * N_z;
              store(N_yz, lines.N[0], N);
              if (grad == nullptr)
                continue;
              store(N_yz, lines.grad[0], grad);
              store(lines.grad[1][j] * N_z, lines.N[0], grad_y);
              if (dim == 3)
                store(lines.N[1][j] * lines.grad[2][k], lines.N[0], grad_z);
            }
        }
      for (unsigned int a = nodes.n; a < nodes.n_padded; ++a)
        {
          N[a] = 0.;
          for (unsigned int d = 0; d < dim && grad != nullptr; ++d)
            grad[d * nodes.n_padded + a] = 0.;
        }
    }
  } // namespace


  template <int dim>
  unsigned int
  lme_tensor_product(const LmeNodes<dim> &nodes,
                     const Point<dim>    &x,
                     Tensor<1, dim>      &lambda,
                     double              *N,
                     double              *grad,
                     const LmeSettings   &settings)
  {
    LineKernel   lines = make_kernel(nodes, x, lambda);
    const double n     = lines.n_nodes;
    const double gamma = nodes.beta[0] * nodes.h * nodes.h;
    if (n > max_line || gamma * (n - 1.) * (n - 1.) > max_gamma)
      return 0;
    // The lengths of r along the directions add up: share the tolerance.
    const unsigned int n_steps =
      solve(lines, settings.tolerance / std::sqrt(double(dim)));
    if (n_steps == 0)
      return 0;

    Lines result;
    fill<dim>(lines, nodes.h, result);
    store_products(nodes, result, N, grad);
    for (unsigned int d = 0; d < dim; ++d)
      lambda[d] = lines.nu[d] / nodes.h;
    return n_steps;
  }

#define SELKIE_INSTANTIATE(dim)                                   \
  template unsigned int lme_tensor_product(const LmeNodes<dim> &, \
                                           const Point<dim> &,    \
                                           Tensor<1, dim> &,      \
                                           double *,              \
                                           double *,              \
                                           const LmeSettings &)
  SELKIE_INSTANTIATE(2);
  SELKIE_INSTANTIATE(3);
#undef SELKIE_INSTANTIATE
} // namespace selkie
