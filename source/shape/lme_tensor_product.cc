#include <selkie/shape/lme.h>
#include <selkie/shape/simd.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using dealii::Point;
  using dealii::Tensor;

  /// Named, for unity builds: lme.cc has thresholds of the same names. Without
  /// a name as well, which lets the compiler inline more: 10 % in 3D.
  namespace tensor_product
  {
    namespace
    {
      using V                          = simd::Native; // the lanes are points
      constexpr unsigned int lanes     = simd::n_lanes<V>;
      constexpr unsigned int max_line  = 32;   // nodes
      constexpr double       max_gamma = 500.; // gamma (n-1)^2
      constexpr unsigned int max_steps = 12;
      constexpr double       longest_step  = 4.;
      constexpr double       accurate_step = 1e-9; // nothing left to gain
      constexpr double       wall_variance = 1e-4; // less than this near a wall

      /// 1 in the lanes where the condition holds, else 0.
      template <class Condition>
      inline V
      indicator(const Condition &condition)
      {
        return condition ? simd::all<V>(1.) : V{};
      }

      /**
       * The one-dimensional functions of several points along one direction of
       * the box, in units of h: t is the distance from node 0 and nu = lambda
       * h. The weight of node i is exp(-gamma (t-i)^2 + nu (t-i)), relative to
       * that of node 0.
       */
      struct Line
      {
        V            t, nu;
        double       gamma, decay;
        unsigned int n_nodes;

        V ratio;                    // weight of node 1 / weight of node 0
        V Z, r, variance, skewness; // the sums (L11)

        /// The sums at nu.
        void
        evaluate()
        {
          ratio   = simd::vexp(V(gamma * (t + t - 1.) - nu));
          V third = {};
          Z = r = variance = V{};
          for_each_node([&](unsigned int, const V &w, const V &u) {
            const V wu = w * u, wuu = wu * u;
            Z += w;
            r += wu;
            variance += wuu;
            third += wuu * u;
          });
          const V factor = 1. / Z, second = variance * factor;
          r *= factor;
          variance = second - r * r;
          skewness = third * factor - r * (2. * variance + second);
        }

        /// Halley's step (L13).
        V
        step() const
        {
          return -2. * r * variance / (2. * variance * variance - r * skewness);
        }

        /// Call f(i, weight, t - i) for the nodes, by the recurrence (L12).
        template <class Function>
        void
        for_each_node(const Function &f) const
        {
          V w = simd::all<V>(1.), rho = ratio, u = t;
#pragma GCC unroll 1
          for (unsigned int i = 0; i < n_nodes; ++i)
            {
              f(i, w, u);
              w *= rho;
              rho *= decay;
              u -= 1.;
            }
        }
      };

      /// The one-dimensional functions and gradients (1/m), node by node.
      struct LineValues
      {
        V N[max_line], grad[max_line];

        /// From the converged weights, by (L6).
        void
        fill(const Line &line, const double h)
        {
          const V factor = 1. / line.Z, slope = (-1. / h) / line.variance;
          line.for_each_node([&](const unsigned int i, const V &w, const V &u) {
            N[i]    = w * factor;
            grad[i] = N[i] * u * slope;
          });
          // Products are computed with whole vectors: rubbish would be slow.
          for (unsigned int i = line.n_nodes; i < lme_padded(line.n_nodes); ++i)
            N[i] = grad[i] = V{};
        }
      };

      /// What consecutive nodes have for one of the points. The vector is put
      /// together in registers: to load what was just stored in pieces stalls.
      inline V
      row(const V *nodes, const unsigned int point)
      {
        V v = {};
        for (unsigned int l = 0; l < lanes; ++l)
          v[l] = nodes[l][point];
        return v;
      }

      /// Store up to n <= lanes entries; rubbish may follow up to room.
      inline void
      store_row(const V           &v,
                const unsigned int n,
                const unsigned int room,
                double            *to)
      {
        if (lanes <= room)
          simd::store(v, to);
        else
          {
            const V part = v; // v itself stays in a register: 10 % faster
            for (unsigned int l = 0; l < n; ++l)
              to[l] = part[l];
          }
      }

      /// A batch of points, at most one in each lane.
      template <int dim>
      class Batch
      {
      public:
        /// n points from x on, which start from lambda. Spare lanes repeat the
        /// first point.
        Batch(const LmeNodes<dim>  &nodes,
              const Point<dim>     *x,
              const Tensor<1, dim> *lambda,
              const unsigned int    n);

        /// Halley's iteration for all points.
        void
        solve(const double tolerance);

        /// The number of steps of a point, 0 if it is left to lme_evaluate():
        /// slow convergence, or a wall is near.
        unsigned int
        n_steps(const unsigned int point) const
        {
          return solved[point] * steps[point];
        }

        Tensor<1, dim>
        lambda(const unsigned int point) const
        {
          Tensor<1, dim> result;
          for (unsigned int d = 0; d < dim; ++d)
            result[d] = lines[d].nu[point] / nodes.h;
          return result;
        }

        /// The one-dimensional functions of all points.
        void
        fill_lines()
        {
          for (unsigned int d = 0; d < dim; ++d)
            values[d].fill(lines[d], nodes.h);
        }

        /// The products (L10) of a point, row after row in x direction.
        void
        store_products(const unsigned int point, double *to) const;

      private:
        const LmeNodes<dim> &nodes;
        Line                 lines[dim];
        V                    steps = {}, solved = {};
        LineValues           values[dim];
      };

      template <int dim>
      Batch<dim>::Batch(const LmeNodes<dim>  &nodes,
                        const Point<dim>     *x,
                        const Tensor<1, dim> *lambda,
                        const unsigned int    n)
        : nodes(nodes)
      {
        for (unsigned int d = 0; d < dim; ++d)
          {
            Line &line = lines[d];
            for (unsigned int l = 0; l < lanes; ++l)
              {
                line.t[l]  = x[l < n ? l : 0][d];
                line.nu[l] = lambda[l < n ? l : 0][d];
              }
            line.t = (line.t - nodes.box_origin[d]) / nodes.h;
            line.nu *= nodes.h;
            line.gamma   = nodes.beta[0] * nodes.h * nodes.h;
            line.decay   = nodes.box_decay;
            line.n_nodes = nodes.box_size[d];
          }
      }

      template <int dim>
      void
      Batch<dim>::solve(const double tolerance)
      {
        V running = simd::all<V>(1.);
        for (unsigned int i = 0; i < max_steps && simd::sum(running) > 0.; ++i)
          {
            V r_square = {}, longest = {}, smallest = simd::all<V>(1.);
            V step[dim];
            for (unsigned int d = 0; d < dim; ++d)
              {
                lines[d].evaluate();
                step[d] = lines[d].step();
                r_square += lines[d].r * lines[d].r;
                longest  = simd::max(longest, simd::max(step[d], V(-step[d])));
                smallest = simd::min(smallest, lines[d].variance);
              }
            steps += running;
            // Points that are done stay where they are, whatever the others do.
            // A NaN compares false: the point is given up.
            running *= indicator(smallest > wall_variance);
            const V done = running *
                           indicator(r_square < tolerance * tolerance) *
                           indicator(longest < accurate_step);
            solved += done;
            running -= done;
            for (unsigned int d = 0; d < dim; ++d)
              {
                const V bounded =
                  simd::min(simd::all<V>(longest_step),
                            simd::max(simd::all<V>(-longest_step), step[d]));
                lines[d].nu += (running > 0. ? bounded : V{});
              }
          }
      }

      template <int dim>
      void
      Batch<dim>::store_products(const unsigned int point, double *to) const
      {
        const auto         size     = nodes.box_size;
        const unsigned int n_planes = (dim == 3 ? size[dim - 1] : 1);
        const unsigned int n_padded = nodes.n_padded;
        // From the ends of the rows to their beginnings, so that what follows a
        // row is overwritten.
        for (unsigned int i = (size[0] + lanes - 1) / lanes * lanes; i > 0;)
          {
            i -= lanes;
            const V            N_x    = row(values[0].N + i, point);
            const V            grad_x = row(values[0].grad + i, point);
            const unsigned int n      = std::min(lanes, size[0] - i);
            for (unsigned int k = 0, a = i; k < n_planes; ++k)
              {
                const double N_z =
                  (dim == 3 ? values[dim - 1].N[k][point] : 1.);
                const double grad_z =
                  (dim == 3 ? values[dim - 1].grad[k][point] : 0.);
                for (unsigned int j = 0; j < size[1]; ++j, a += size[0])
                  {
                    const double N_y    = values[1].N[j][point];
                    const double grad_y = values[1].grad[j][point];
                    const auto   store = [&](const V &v, const unsigned int c) {
                      store_row(v, n, n_padded - a, to + c * n_padded + a);
                    };
                    const double N_yz = N_y * N_z;
                    store(N_yz * N_x, 0);
                    store(N_yz * grad_x, 1);
                    store((grad_y * N_z) * N_x, 2);
                    if (dim == 3)
                      store((N_y * grad_z) * N_x, 3);
                  }
              }
          }
        for (unsigned int c = 0; c <= dim; ++c)
          for (unsigned int a = nodes.n; a < n_padded; ++a)
            to[c * n_padded + a] = 0.;
      }

      /// Whether the recurrence (L12) stays in the range of doubles.
      template <int dim>
      bool
      is_in_range(const LmeNodes<dim> &nodes)
      {
        const double n =
          *std::max_element(nodes.box_size.begin(), nodes.box_size.end());
        const double gamma = nodes.beta[0] * nodes.h * nodes.h;
        return n <= max_line && gamma * (n - 1.) * (n - 1.) <= max_gamma;
      }
    } // namespace
  }   // namespace tensor_product


  template <int dim>
  unsigned int
  lme_evaluate_points(const LmeNodes<dim>           &nodes,
                      const std::vector<Point<dim>> &x,
                      std::vector<Tensor<1, dim>>   &lambda,
                      double                        *values,
                      const LmeSettings             &settings)
  {
    using tensor_product::Batch, tensor_product::lanes;
    AssertDimension(x.size(), lambda.size());
    const std::size_t stride  = (dim + 1) * nodes.n_padded;
    unsigned int      n_steps = 0;
    const auto        general = [&](const unsigned int q) {
      double *N = values + q * stride;
      n_steps +=
        lme_evaluate(nodes, x[q], lambda[q], N, N + nodes.n_padded, settings);
    };
    if (!nodes.is_box || !tensor_product::is_in_range(nodes))
      {
        for (unsigned int q = 0; q < x.size(); ++q)
          general(q);
        return n_steps;
      }

    for (unsigned int first = 0; first < x.size(); first += lanes)
      {
        const unsigned int n = std::min<std::size_t>(lanes, x.size() - first);
        Batch<dim>         batch(nodes, &x[first], &lambda[first], n);
        batch.solve(settings.tolerance);
        batch.fill_lines();
        for (unsigned int l = 0; l < n; ++l)
          if (const unsigned int steps = batch.n_steps(l))
            {
              n_steps += steps;
              lambda[first + l] = batch.lambda(l);
              batch.store_products(l, values + (first + l) * stride);
            }
          else
            general(first + l);
      }
    return n_steps;
  }

#define SELKIE_INSTANTIATE(dim)                                              \
  template unsigned int lme_evaluate_points(const LmeNodes<dim> &,           \
                                            const std::vector<Point<dim>> &, \
                                            std::vector<Tensor<1, dim>> &,   \
                                            double *,                        \
                                            const LmeSettings &)
  SELKIE_INSTANTIATE(2);
  SELKIE_INSTANTIATE(3);
#undef SELKIE_INSTANTIATE
} // namespace selkie
