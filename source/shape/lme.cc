#include <selkie/shape/lme.h>
#include <selkie/shape/simd.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace selkie
{
  using dealii::Point;
  using dealii::Tensor;

  template <int dim>
  void
  LmeNodes<dim>::reinit(const std::vector<Point<dim>> &points,
                        const std::vector<double>     &node_beta,
                        const double                   spacing)
  {
    Assert(points.size() == node_beta.size(),
           dealii::ExcDimensionMismatch(points.size(), node_beta.size()));
    n        = points.size();
    n_padded = lme_padded(n);
    h        = spacing;
    is_box   = false;
    beta.resize(n_padded);
    for (auto &coordinate : x)
      coordinate.resize(n_padded);
    uniform_beta = true;
    for (unsigned int a = 0; n > 0 && a < n_padded; ++a)
      {
        const unsigned int source = (a < n ? a : 0);
        beta[a]                   = node_beta[source];
        uniform_beta              = uniform_beta && beta[a] == beta[0];
        for (unsigned int d = 0; d < dim; ++d)
          x[d][a] = points[source][d];
      }
  }

  template <int dim>
  LmeNodes<dim>
  LmeNodes<dim>::make_box(const Point<dim>                    &origin,
                          const double                         spacing,
                          const std::array<unsigned int, dim> &size,
                          const double                         beta)
  {
    unsigned int n_nodes = 1;
    for (const unsigned int s : size)
      n_nodes *= s;
    std::vector<Point<dim>> points(n_nodes);
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int d = 0, rest = a; d < dim; rest /= size[d], ++d)
        points[a][d] = origin[d] + spacing * (rest % size[d]);

    LmeNodes<dim> nodes;
    nodes.reinit(points, std::vector<double>(n_nodes, beta), spacing);
    nodes.is_box     = true;
    nodes.box_size   = size;
    nodes.box_origin = origin;
    nodes.box_decay  = std::exp(-2. * beta * spacing * spacing);
    return nodes;
  }

  double
  lme_support_radius(const double h, const double gamma, const double tolerance)
  {
    return h * std::sqrt(-std::log(tolerance) / gamma);
  }

  namespace
  {
    using V                      = simd::Native;
    constexpr unsigned int lanes = simd::n_lanes<V>;
    static_assert(lme_padding % lanes == 0, "padding fills whole vectors");

    // Thresholds; lengths in units of h.
    constexpr double newton_region    = 1e-4;   // |r|: full steps from here on
    constexpr double small_step       = 1.5e-3; // |step|: vexp_small suffices
    constexpr double longest_step     = 10.;    // |step|
    constexpr double accurate_step    = 1e-10;  // |step|: nothing left to gain
    constexpr double wall_inverse     = 1e9; // |H^-1|: at the hull's boundary
    constexpr double inward_shifts[]  = {1e-8, 1e-10, 1e-12}; // see (L8)
    constexpr double roundoff_outside = 1e-12;

    /// The components of a vector, for one node in each lane.
    template <int dim>
    struct Vectors
    {
      V component[dim];

      V &
      operator[](const unsigned int i)
      {
        return component[i];
      }

      const V &
      operator[](const unsigned int i) const
      {
        return component[i];
      }
    };

    /**
     * The kernel for any list of nodes: one point, the lanes are nodes.
     * Its state is the last lambda with the sums that follow from it; the
     * array E holds exp(-beta_a|d_a|^2 + lambda.d_a - shift), not divided by Z.
     */
    template <int dim>
    class GeneralKernel
    {
    public:
      GeneralKernel(const LmeNodes<dim> &nodes,
                    const Point<dim>    &x,
                    const LmeSettings   &settings,
                    double              *E)
        : nodes(nodes)
        , settings(settings)
        , h(nodes.h)
        , E(E)
        , x(x)
      {}

      /// Start from the better of the given lambda and zero.
      void
      start(const Tensor<1, dim> &guess);

      /// Newton's iteration (L4). True when converged; false when the point
      /// turns out to be at the boundary of the hull or beyond (only if asked
      /// to stop there), or when the iteration gets nowhere.
      bool
      newton(const bool stop_at_wall);

      /// Divide E by Z, which makes it N.
      void
      normalise() const;

      /// Gradients (L6), (L7) from normalised N.
      void
      gradients(double *grad) const;

      /// True if a plane through the point has all nodes on one side and the
      /// hull is further away than round-off: the proof (L9).
      bool
      is_outside() const;

      const LmeNodes<dim> &nodes;
      const LmeSettings   &settings;
      const double         h;
      double *const        E;
      Point<dim>           x;
      Tensor<1, dim>       lambda;
      unsigned int         n_steps = 0;

    private:
      /// Evaluate E and the sums at a lambda, by exp.
      void
      evaluate_at(const Tensor<1, dim> &new_lambda);

      /// The same at lambda + step, by a multiplication of E when the step is
      /// small enough.
      void
      advance(const Tensor<1, dim> &step);

      /// Move along a descent direction of ln Z (Armijo); false and state
      /// restored if there is no decrease.
      bool
      line_search(const Tensor<1, dim> &step);

      /// H^-1, or false if H is singular.
      bool
      invert_hessian();

      template <class Exponential>
      void
      accumulate(const Exponential &exponential);

      /// m_beta = sum N_b beta_b d_b and J_beta = sum N_b beta_b d_b (x) d_b.
      void
      weighted_sums(Tensor<1, dim> &m_beta, Tensor<2, dim> &J_beta) const;

      double
      largest_exponent(const Tensor<1, dim> &at_lambda) const;

      double
      log_Z() const
      {
        return std::log(Z) + shift;
      }

      double         shift = 0.;
      double         Z     = 0.;
      Tensor<1, dim> r;
      Tensor<2, dim> H, H_inverse;
    };

    /// How far outside the hull a point may lie by round-off (m).
    template <int dim>
    double
    roundoff(const Point<dim> &x, const double h)
    {
      double largest = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        largest = std::max(largest, std::abs(x[d]));
      return roundoff_outside * h +
             4. * std::numeric_limits<double>::epsilon() * largest;
    }

    template <int dim>
    inline Vectors<dim>
    distances(const LmeNodes<dim> &nodes,
              const Point<dim>    &x,
              const unsigned int   a)
    {
      Vectors<dim> d;
      for (unsigned int i = 0; i < dim; ++i)
        d[i] = x[i] - simd::load<V>(&nodes.x[i][a]);
      return d;
    }

    template <int dim>
    inline V
    dot(const Vectors<dim> &d, const Tensor<1, dim> &vector)
    {
      V sum = d[0] * vector[0];
      for (unsigned int i = 1; i < dim; ++i)
        sum += d[i] * vector[i];
      return sum;
    }

    template <int dim>
    inline V
    square(const Vectors<dim> &d)
    {
      V sum = d[0] * d[0];
      for (unsigned int i = 1; i < dim; ++i)
        sum += d[i] * d[i];
      return sum;
    }


    /// The sums Z, r and H (L2), (L3) of the weights that exponential(a, d)
    /// returns for the nodes a ... a+lanes-1, which are stored in E.
    template <int dim>
    template <class Exponential>
    void
    GeneralKernel<dim>::accumulate(const Exponential &exponential)
    {
      constexpr unsigned int n_second = dim * (dim + 1) / 2;
      V                      zeroth   = {};
      std::array<V, dim>     first;
      first.fill(V{});
      std::array<V, n_second> second;
      second.fill(V{});
      for (unsigned int a = 0; a < nodes.n_padded; a += lanes)
        {
          const Vectors<dim> d = distances(nodes, x, a);
          V                  e = exponential(a, d);
          if (a + lanes > nodes.n)
            e = simd::first_lanes(e, double(nodes.n) - a);
          simd::store(e, E + a);
          zeroth += e;
          for (unsigned int i = 0, ij = 0; i < dim; ++i)
            {
              const V ed = e * d[i];
              first[i] += ed;
              for (unsigned int j = i; j < dim; ++j, ++ij)
                second[ij] += ed * d[j];
            }
        }
      Z = simd::sum(zeroth);
      for (unsigned int i = 0; i < dim; ++i)
        r[i] = simd::sum(first[i]) / Z;
      for (unsigned int i = 0, ij = 0; i < dim; ++i)
        for (unsigned int j = i; j < dim; ++j, ++ij)
          H[i][j] = H[j][i] = simd::sum(second[ij]) / Z - r[i] * r[j];
    }

    template <int dim>
    void
    GeneralKernel<dim>::evaluate_at(const Tensor<1, dim> &new_lambda)
    {
      lambda              = new_lambda;
      const auto evaluate = [&]() {
        accumulate([&](const unsigned int a, const Vectors<dim> &d) {
          return simd::vexp(V(dot(d, lambda) -
                              simd::load<V>(&nodes.beta[a]) * square(d) -
                              shift));
        });
      };
      evaluate();
      // The shift is that of the last lambda, mostly zero; renew it only when
      // the exponentials leave the range of doubles.
      if (!(Z > 1e-200 && Z < 1e200))
        {
          shift = largest_exponent(lambda);
          evaluate();
        }
    }

    template <int dim>
    void
    GeneralKernel<dim>::advance(const Tensor<1, dim> &step)
    {
      if (step.norm() * h > small_step)
        {
          evaluate_at(lambda + step);
          return;
        }
      lambda += step;
      accumulate([&](const unsigned int a, const Vectors<dim> &d) {
        return simd::load<V>(E + a) * simd::vexp_small(dot(d, step));
      });
    }

    template <int dim>
    double
    GeneralKernel<dim>::largest_exponent(const Tensor<1, dim> &at_lambda) const
    {
      V largest = simd::all<V>(std::numeric_limits<double>::lowest());
      for (unsigned int a = 0; a < nodes.n_padded; a += lanes)
        {
          const Vectors<dim> d = distances(nodes, x, a);
          largest              = simd::max(largest,
                              dot(d, at_lambda) -
                                simd::load<V>(&nodes.beta[a]) * square(d));
        }
      return simd::largest_lane(largest);
    }

    template <int dim>
    bool
    GeneralKernel<dim>::invert_hessian()
    {
      const Tensor<2, dim> scaled = H / (h * h);
      if (!(determinant(scaled) > 1e-100))
        return false;
      H_inverse = invert(scaled) / (h * h);
      return true;
    }

    template <int dim>
    void
    GeneralKernel<dim>::start(const Tensor<1, dim> &guess)
    {
      evaluate_at(guess);
      // Compare with zero only when the guess is not good: a pass is saved.
      if (guess != Tensor<1, dim>() && !(r.norm() < 0.1 * h))
        {
          const double guessed = log_Z();
          evaluate_at(Tensor<1, dim>());
          if (guessed < log_Z())
            evaluate_at(guess);
        }
    }

    template <int dim>
    bool
    GeneralKernel<dim>::line_search(const Tensor<1, dim> &step)
    {
      const Tensor<1, dim> lambda_0 = lambda;
      const double         log_Z_0 = log_Z(), slope = r * step;
      for (double alpha = 1.; alpha > 1e-3; alpha *= 0.5)
        {
          evaluate_at(lambda_0 + alpha * step);
          if (log_Z() <= log_Z_0 + 1e-4 * alpha * slope)
            return true;
        }
      evaluate_at(lambda_0);
      return false;
    }

    template <int dim>
    bool
    GeneralKernel<dim>::newton(const bool stop_at_wall)
    {
      unsigned int n_extra = 0;
      for (unsigned int i = 0; i < settings.max_iterations; ++i, ++n_steps)
        {
          const bool   regular    = invert_hessian();
          const double r_norm     = r.norm();
          const auto   regularise = [&]() {
            Tensor<2, dim> M = H;
            for (unsigned int d = 0; d < dim; ++d)
              M[d][d] += h * r_norm;
            return -(invert(M) * r);
          };
          if (stop_at_wall &&
              (!regular || H_inverse.norm() * h * h > wall_inverse))
            return false;

          Tensor<1, dim> step      = regular ? -(H_inverse * r) : regularise();
          const double   length    = step.norm() * h;
          const bool     converged = r_norm < settings.tolerance * h;
          if (converged && regular &&
              (length < accurate_step || n_extra++ == 2))
            return true;
          if (length > longest_step)
            step *= longest_step / length;

          // Close to the minimum ln Z no longer tells up from down.
          if (r_norm < newton_region * h || length < small_step ||
              -(r * step) < 1e-13)
            advance(step);
          else if (!line_search(step) && !line_search(regularise()))
            return false;
        }
      return false;
    }

    template <int dim>
    bool
    GeneralKernel<dim>::is_outside() const
    {
      V largest = simd::all<V>(std::numeric_limits<double>::lowest());
      for (unsigned int a = 0; a < nodes.n_padded; a += lanes)
        largest = simd::max(largest, V(-dot(distances(nodes, x, a), r)));
      return r.norm() > roundoff(x, h) &&
             simd::largest_lane(largest) < -0.5 * r.norm_square();
    }

    template <int dim>
    void
    GeneralKernel<dim>::normalise() const
    {
      const double factor = 1. / Z;
      for (unsigned int a = 0; a < nodes.n_padded; a += lanes)
        simd::store(V(simd::load<V>(E + a) * factor), E + a);
    }

    template <int dim>
    void
    GeneralKernel<dim>::gradients(double *grad) const
    {
      // grad N_a = N_a (A d_a - 2 beta_a d_a + c); for one beta A = -H^-1,
      // and the rest is nil.
      Tensor<2, dim> A = -H_inverse;
      Tensor<1, dim> c;
      if (!nodes.uniform_beta)
        {
          Tensor<2, dim> J_beta;
          weighted_sums(c, J_beta);
          c *= 2.;
          A += 2. * J_beta * H_inverse;
        }
      for (unsigned int a = 0; a < nodes.n_padded; a += lanes)
        {
          const V            N        = simd::load<V>(E + a);
          const Vectors<dim> d        = distances(nodes, x, a);
          V                  two_beta = {};
          if (!nodes.uniform_beta)
            two_beta = 2. * simd::load<V>(&nodes.beta[a]);
          for (unsigned int i = 0; i < dim; ++i)
            simd::store(V(N * (dot(d, A[i]) - two_beta * d[i] + c[i])),
                        grad + i * nodes.n_padded + a);
        }
    }

    template <int dim>
    void
    GeneralKernel<dim>::weighted_sums(Tensor<1, dim> &m_beta,
                                      Tensor<2, dim> &J_beta) const
    {
      constexpr unsigned int n_second = dim * (dim + 1) / 2;
      std::array<V, dim>     first;
      first.fill(V{});
      std::array<V, n_second> second;
      second.fill(V{});
      for (unsigned int a = 0; a < nodes.n_padded; a += lanes)
        {
          const Vectors<dim> d = distances(nodes, x, a);
          const V w = simd::load<V>(E + a) * simd::load<V>(&nodes.beta[a]);
          for (unsigned int i = 0, ij = 0; i < dim; ++i)
            {
              first[i] += w * d[i];
              for (unsigned int j = i; j < dim; ++j, ++ij)
                second[ij] += w * d[i] * d[j];
            }
        }
      for (unsigned int i = 0, ij = 0; i < dim; ++i)
        {
          m_beta[i] = simd::sum(first[i]);
          for (unsigned int j = i; j < dim; ++j, ++ij)
            J_beta[i][j] = J_beta[j][i] = simd::sum(second[ij]);
        }
    }


    /// From x to a point that is strictly inside the nodes' hull: a mean of
    /// theirs in which no two count alike, which keeps away from planes of
    /// symmetry. In these the functions of either side are tiny, and H with
    /// them.
    template <int dim>
    Tensor<1, dim>
    inward_direction(const LmeNodes<dim> &nodes, const Point<dim> &x)
    {
      constexpr double golden = 0.6180339887498949;
      Tensor<1, dim>   inward;
      for (unsigned int a = 0; a < nodes.n; ++a)
        {
          const double count = 1. + a * golden - std::floor(a * golden);
          for (unsigned int d = 0; d < dim; ++d)
            inward[d] += count * (nodes.x[d][a] - x[d]);
        }
      const double norm = inward.norm();
      return norm > 0. ? inward / norm : inward;
    }

    /// N at x from N and its gradients at the kernel's point (L8). Returns
    /// whether none is more negative than by round-off.
    template <int dim>
    bool
    extrapolate(GeneralKernel<dim> &kernel,
                const Point<dim>   &x,
                const double       *grad)
    {
      const LmeNodes<dim> &nodes = kernel.nodes;
      const Tensor<1, dim> back  = x - kernel.x;
      const double         least = -roundoff(x, nodes.h) / nodes.h;
      bool                 fits  = true;
      for (unsigned int a = 0; a < nodes.n; ++a)
        {
          double &N = kernel.E[a];
          for (unsigned int d = 0; d < dim; ++d)
            N += grad[d * nodes.n_padded + a] * back[d];
          fits = fits && N >= least;
          N    = std::max(N, 0.);
        }
      return fits;
    }

    /// Points that the plain iteration gave up: at the boundary of the hull
    /// (L8), or outside.
    template <int dim>
    void
    evaluate_at_wall(GeneralKernel<dim> &kernel, double *grad)
    {
      const LmeNodes<dim> &nodes = kernel.nodes;
      const Point<dim>     x     = kernel.x;
      if (kernel.is_outside())
        throw OutsideHull<dim>(x, "it lies outside the hull of its nodes");
      std::vector<double> own_gradients(grad ? 0 : dim * nodes.n_padded);
      if (grad == nullptr)
        grad = own_gradients.data();
      const Tensor<1, dim> inward = inward_direction(nodes, x);
      for (const double shift : inward_shifts)
        {
          kernel.x = x + shift * nodes.h * inward;
          kernel.start(kernel.lambda);
          if (!kernel.newton(false))
            throw OutsideHull<dim>(
              x,
              "the iteration for lambda does not converge: "
              "outside the hull, or nodes all in one plane");
          kernel.normalise();
          kernel.gradients(grad);
          if (extrapolate(kernel, x, grad))
            return;
        }
      throw OutsideHull<dim>(x, "it lies outside the hull of its nodes");
    }
  } // namespace


  template <int dim>
  unsigned int
  lme_evaluate(const LmeNodes<dim> &nodes,
               const Point<dim>    &x,
               Tensor<1, dim>      &lambda,
               double              *N,
               double              *grad,
               const LmeSettings   &settings)
  {
    if (nodes.n < dim + 1)
      throw OutsideHull<dim>(x,
                             "it has only " + std::to_string(nodes.n) +
                               " nodes");

    GeneralKernel<dim> kernel(nodes, x, settings, N);
    kernel.start(lambda);
    if (kernel.newton(true))
      {
        kernel.normalise();
        if (grad != nullptr)
          kernel.gradients(grad);
      }
    else
      evaluate_at_wall(kernel, grad);
    lambda = kernel.lambda;
    return kernel.n_steps;
  }


#define SELKIE_INSTANTIATE(dim)                             \
  template struct LmeNodes<dim>;                            \
  template unsigned int lme_evaluate(const LmeNodes<dim> &, \
                                     const Point<dim> &,    \
                                     Tensor<1, dim> &,      \
                                     double *,              \
                                     double *,              \
                                     const LmeSettings &)
  SELKIE_INSTANTIATE(2);
  SELKIE_INSTANTIATE(3);
#undef SELKIE_INSTANTIATE
} // namespace selkie
