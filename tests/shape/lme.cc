// LME shape functions: what the theory promises (doc/theory.md), in the
// interior, at walls, edges and corners, on graded nodes, and outside.
#include <selkie/shape/lme.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

using namespace selkie;
using dealii::AlignedVector;
using dealii::Point;
using dealii::Tensor;

namespace
{
  const std::vector<double> gammas = {0.8, 1.8, 3., 4.};

  // Newton stops at |r| < 1e-12 h and |H^-1 r| < 1e-10/h. The gradients'
  // identities hold up to that: sum_a grad N_a = -H^-1 r for one beta.
  constexpr double gradient_accuracy = 1e-10;

  template <int dim>
  struct Values
  {
    AlignedVector<double> N, grad;
    Tensor<1, dim>        lambda;
    unsigned int          n_steps;
  };

  template <int dim>
  Values<dim>
  evaluate(const LmeNodes<dim>  &nodes,
           const Point<dim>     &x,
           const Tensor<1, dim> &start = Tensor<1, dim>())
  {
    Values<dim> v;
    v.N.resize(nodes.n_padded, -7.);
    v.grad.resize(dim * nodes.n_padded, -7.);
    v.lambda  = start;
    v.n_steps = lme_evaluate(nodes, x, v.lambda, v.N.data(), v.grad.data());
    return v;
  }

  /// Many points of one list in a single call.
  template <int dim>
  std::vector<Values<dim>>
  evaluate_points(const LmeNodes<dim>            &nodes,
                  const std::vector<Point<dim>>  &x,
                  const std::vector<Values<dim>> &start = {})
  {
    const unsigned int          stride = (dim + 1) * nodes.n_padded;
    std::vector<Tensor<1, dim>> lambda(x.size());
    for (unsigned int q = 0; q < start.size(); ++q)
      lambda[q] = start[q].lambda;
    AlignedVector<double> all(x.size() * stride + lme_padding, -7.);
    const unsigned int    n_steps =
      lme_evaluate_points(nodes, x, lambda, all.data());
    for (unsigned int i = x.size() * stride; i < all.size(); ++i)
      EXPECT_EQ(all[i], -7.) << "written past the end";

    std::vector<Values<dim>> result(x.size());
    for (unsigned int q = 0; q < x.size(); ++q)
      {
        Values<dim>  &v    = result[q];
        const double *from = all.data() + q * stride;
        v.N.resize(nodes.n_padded);
        v.grad.resize(dim * nodes.n_padded);
        std::copy(from, from + nodes.n_padded, v.N.begin());
        std::copy(from + nodes.n_padded, from + stride, v.grad.begin());
        v.lambda  = lambda[q];
        v.n_steps = n_steps; // of all
      }
    return result;
  }

  template <int dim>
  Point<dim>
  node(const LmeNodes<dim> &nodes, const unsigned int a)
  {
    Point<dim> p;
    for (unsigned int d = 0; d < dim; ++d)
      p[d] = nodes.x[d][a];
    return p;
  }

  /// The grid points h (i,j,k), 0 <= i,j,k <= 8, within R of x.
  template <int dim>
  LmeNodes<dim>
  grid_near(const Point<dim> &x, const double h, const double gamma)
  {
    const double            R = lme_support_radius(h, gamma, 1e-6);
    std::vector<Point<dim>> points;
    for (unsigned int a = 0; a < (dim == 3 ? 729 : 81); ++a)
      {
        Point<dim> p;
        for (unsigned int d = 0, rest = a; d < dim; ++d, rest /= 9)
          p[d] = h * (rest % 9);
        if (p.distance(x) < R)
          points.push_back(p);
      }
    LmeNodes<dim> nodes;
    nodes.reinit(points,
                 std::vector<double>(points.size(), gamma / (h * h)),
                 h);
    return nodes;
  }

  template <int dim>
  std::vector<Point<dim>>
  random_points(const unsigned int n, const double low, const double high)
  {
    std::mt19937                     random(42);
    std::uniform_real_distribution<> uniform(low, high);
    std::vector<Point<dim>>          points(n);
    for (auto &p : points)
      for (unsigned int d = 0; d < dim; ++d)
        p[d] = uniform(random);
    return points;
  }

  /// Errors of the four identities; those of x and the gradients relative to h.
  struct Errors
  {
    double unity = 0., linear = 0., grad_unity = 0., grad_linear = 0.;
    double smallest = 1.;
  };

  template <int dim>
  Errors
  identities(const LmeNodes<dim> &nodes,
             const Point<dim>    &x,
             const Values<dim>   &v)
  {
    double         sum = -1.;
    Tensor<1, dim> r, grad_sum;
    Tensor<2, dim> grad_x;
    Errors         e;
    for (unsigned int a = 0; a < nodes.n; ++a)
      {
        const Tensor<1, dim> d = node(nodes, a) - x;
        sum += v.N[a];
        r += v.N[a] * d;
        e.smallest = std::min(e.smallest, v.N[a]);
        for (unsigned int i = 0; i < dim; ++i)
          {
            const double g = v.grad[i * nodes.n_padded + a];
            grad_sum[i] += g;
            for (unsigned int j = 0; j < dim; ++j)
              grad_x[i][j] += g * d[j];
          }
      }
    for (unsigned int i = 0; i < dim; ++i)
      grad_x[i][i] -= 1.;
    e.unity       = std::abs(sum);
    e.linear      = r.norm() / nodes.h;
    e.grad_unity  = grad_sum.norm() * nodes.h;
    e.grad_linear = grad_x.norm();
    return e;
  }

  template <int dim>
  void
  expect_identities(const LmeNodes<dim> &nodes,
                    const Point<dim>    &x,
                    const Values<dim>   &v,
                    const double         gradient_tolerance)
  {
    const Errors e = identities(nodes, x, v);
    EXPECT_LT(e.unity, 1e-13) << x;
    EXPECT_LT(e.linear, 1e-12) << x;
    EXPECT_LT(e.grad_unity, gradient_tolerance) << x;
    EXPECT_LT(e.grad_linear, gradient_tolerance) << x;
    EXPECT_GE(e.smallest, 0.) << x;
    for (unsigned int a = nodes.n; a < nodes.n_padded; ++a)
      {
        EXPECT_EQ(v.N[a], 0.);
        for (unsigned int d = 0; d < dim; ++d)
          EXPECT_EQ(v.grad[d * nodes.n_padded + a], 0.);
      }
  }

  /// Largest difference (times h) between the gradient and central differences
  /// of step 1e-5 h on the same list. The truncation error is about
  /// 1e-10 |N'''| / 6 h^2 (a few 1e-10 / h), round-off 1e-15/1e-5 = 1e-10/h.
  template <int dim>
  double
  difference_to_fd(const LmeNodes<dim> &nodes,
                   const Point<dim>    &x,
                   const Values<dim>   &v,
                   const double         step = 1e-5)
  {
    double largest = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        Point<dim> plus = x, minus = x;
        plus[d] += step * nodes.h;
        minus[d] -= step * nodes.h;
        const auto vp = evaluate(nodes, plus), vm = evaluate(nodes, minus);
        for (unsigned int a = 0; a < nodes.n; ++a)
          largest =
            std::max(largest,
                     nodes.h *
                       std::abs((vp.N[a] - vm.N[a]) / (plus[d] - minus[d]) -
                                v.grad[d * nodes.n_padded + a]));
      }
    return largest;
  }

  /// Spacing 1 left of x = 4 and 1/2 right of it: the nodes (4, j + 1/2, ...)
  /// hang. beta_a = gamma / h_a^2 with the finer h at the interface.
  template <int dim>
  LmeNodes<dim>
  graded(const double gamma)
  {
    std::vector<Point<dim>> points;
    std::vector<double>     beta;
    for (int k = 0; k <= (dim == 3 ? 8 : 0); ++k)
      for (int j = 0; j <= 8; ++j)
        for (int i = 0; i <= 16; ++i)
          {
            const bool fine = (i >= 8);
            if (!fine && (i % 2 || j % 2 || k % 2))
              continue;
            Point<dim> p;
            p[0] = .5 * i;
            p[1] = .5 * j;
            if (dim == 3)
              p[dim - 1] = .5 * k;
            points.push_back(p);
            beta.push_back(gamma * (fine ? 4. : 1.));
          }
    LmeNodes<dim> nodes;
    nodes.reinit(points, beta, 0.5);
    return nodes;
  }
} // namespace


template <typename T>
class Lme : public testing::Test
{};
using Dimensions = testing::Types<std::integral_constant<int, 2>,
                                  std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Lme, Dimensions);


TYPED_TEST(Lme, IdentitiesAndGradientInside)
{
  constexpr int dim = TypeParam::value;
  const double  h   = 0.01;
  for (const double gamma : gammas)
    for (const auto &x : random_points<dim>(100, 3 * h, 5 * h))
      {
        const auto nodes = grid_near(x, h, gamma);
        const auto v     = evaluate(nodes, x);
        expect_identities(nodes, x, v, gradient_accuracy);
        EXPECT_LT(difference_to_fd(nodes, x, v), 1e-7);
        EXPECT_LE(v.n_steps, 6u);
      }
}


// The list of a point in a cell at a wall is one-sided.
TYPED_TEST(Lme, BoundaryCells)
{
  constexpr int dim = TypeParam::value;
  for (const double gamma : gammas)
    for (const auto &x : random_points<dim>(100, 0.01, 1.))
      {
        const auto nodes = grid_near(x, 1., gamma);
        const auto v     = evaluate(nodes, x);
        expect_identities(nodes, x, v, gradient_accuracy);
        EXPECT_LT(difference_to_fd(nodes, x, v), 1e-7);
      }
}


TYPED_TEST(Lme, GradedNodesWithNodewiseBeta)
{
  constexpr int dim = TypeParam::value;
  for (const double gamma : gammas)
    {
      const auto nodes = graded<dim>(gamma);
      EXPECT_FALSE(nodes.uniform_beta);
      for (auto x : random_points<dim>(100, 0.5, 3.5))
        {
          x[0] += 2.; // both sides of the interface at x = 4
          const auto v = evaluate(nodes, x);
          expect_identities(nodes, x, v, gradient_accuracy);
          EXPECT_LT(difference_to_fd(nodes, x, v), 1e-7);
        }
    }
}


// From 0.1 h to 1e-10 h, and on the wall, for n_walls walls that meet (1: wall,
// 2: edge in 3D and corner in 2D, 3: corner in 3D). The gradients' identities
// are seen to hold to 9e-11 here, where the walls are along the axes and
// distances to them are exact; 1e-9 leaves room for other round-off. These are
// the identities; the gradient itself is in error by about 1e-8/h where the
// inward shift (L8) is used, see LimitAtTheWallIsLinear.
TYPED_TEST(Lme, TowardsWallsEdgesAndCorners)
{
  constexpr int dim   = TypeParam::value;
  double        worst = 0.;
  for (const double gamma : gammas)
    for (int n_walls = 1; n_walls <= dim; ++n_walls)
      for (int power = 1; power <= 11; ++power)
        {
          const double eps = (power == 11 ? 0. : std::pow(10., -power));
          Point<dim>   x;
          for (int d = 0; d < dim; ++d)
            x[d] = (d < n_walls ? eps : 2.3 + 0.4 * d);
          const auto   nodes = grid_near(x, 1., gamma);
          const auto   v     = evaluate(nodes, x);
          const Errors e     = identities(nodes, x, v);
          expect_identities(nodes, x, v, 1e-9);
          EXPECT_LT(v.lambda.norm(), 100.);
          worst = std::max({worst, e.grad_unity, e.grad_linear});
        }
  this->RecordProperty("worst_gradient_identity_1e12",
                       std::to_string(1e12 * worst));
}


// The nodes of the cells that points happen to be in, when round-off decides on
// which side of a face each of them lies: hulls with oblique faces and edges,
// and points up to 1e-12 h inside them. Towards such an edge functions tend to
// zero like distance^p with p near 1, which the step back of (L8) makes
// negative; it is made from nearer then. Of 20 000 such points 2 are refused in
// 3D (18 if all steps are 1e-8 h). Next to planes of symmetry H is small, and
// round-off of 1e-16 in it leaves some per cent in gradients.
TYPED_TEST(Lme, RaggedHulls)
{
  constexpr int                      dim     = TypeParam::value;
  constexpr unsigned int             n_cells = dim == 3 ? 27 : 9;
  std::mt19937                       random(7);
  std::uniform_int_distribution<int> coin(0, 1), third(0, 2);
  unsigned int                       refused = 0;
  for (unsigned int trial = 0; trial < 20000; ++trial)
    {
      std::set<std::array<int, dim>> corners;
      for (unsigned int c = 0; c < n_cells; ++c)
        if (c == n_cells / 2 || third(random) == 0)
          for (unsigned int v = 0; v < (1u << dim); ++v)
            {
              std::array<int, dim> corner;
              for (unsigned int d = 0, rest = c; d < dim; ++d, rest /= 3)
                corner[d] = rest % 3 + ((v >> d) & 1);
              corners.insert(corner);
            }
      std::vector<Point<dim>> points;
      for (const auto &corner : corners)
        {
          points.emplace_back();
          for (unsigned int d = 0; d < dim; ++d)
            points.back()[d] = corner[d];
        }
      const double  gamma = gammas[trial % gammas.size()];
      LmeNodes<dim> nodes;
      nodes.reinit(points, std::vector<double>(points.size(), gamma), 1.);

      // A corner, edge or face of the cell in the middle, from inside.
      Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        {
          const double inside   = 1e-13 * (trial % 11) * (1 + coin(random));
          const double places[] = {1. + inside, 2. - inside, 1.4};
          x[d]                  = places[third(random)];
        }
      Errors e;
      try
        {
          e = identities(nodes, x, evaluate(nodes, x));
        }
      catch (const OutsideHull<dim> &)
        {
          ++refused;
        }
      EXPECT_LT(e.unity, 3e-12) << x;
      EXPECT_LT(e.linear, 5e-10) << x;
      EXPECT_LT(std::max(e.grad_unity, e.grad_linear), 0.1) << x;
      EXPECT_GE(e.smallest, 0.) << x;
    }
  EXPECT_LE(refused, 2u); // none is wanted: keeps it from getting worse
}


// The same for walls at 45 and other degrees: the grid is rotated.
TEST(LmeWalls, Oblique)
{
  double worst = 0.;
  for (const double gamma : gammas)
    for (const double angle : {0.1, 0.7853981633974483, 1.2})
      for (int n_walls = 1; n_walls <= 2; ++n_walls)
        for (int power = 1; power <= 11; ++power)
          {
            const double   eps = (power == 11 ? 0. : std::pow(10., -power));
            const Point<2> y(eps, n_walls == 2 ? eps : 2.3);
            const double   c = std::cos(angle), s = std::sin(angle);
            const auto     rotate = [&](const Point<2> &p) {
              return Point<2>(c * p[0] - s * p[1], s * p[0] + c * p[1]);
            };
            const auto            straight = grid_near(y, 1., gamma);
            std::vector<Point<2>> points;
            for (unsigned int a = 0; a < straight.n; ++a)
              points.push_back(rotate(node(straight, a)));
            LmeNodes<2> nodes;
            nodes.reinit(points, std::vector<double>(straight.n, gamma), 1.);
            const Point<2> x = rotate(y);
            const auto     v = evaluate(nodes, x), w = evaluate(straight, y);
            // Seen: 6e-8, which is round-off 1e-16 h/eps at eps = 1e-9 h.
            expect_identities(nodes, x, v, 3e-7);
            const Errors e = identities(nodes, x, v);
            worst          = std::max({worst, e.grad_unity, e.grad_linear});
            for (unsigned int a = 0; a < nodes.n; ++a)
              EXPECT_NEAR(v.N[a], w.N[a], 1e-12);
          }
  RecordProperty("worst_gradient_identity_1e12", std::to_string(1e12 * worst));
}


// At a wall the exact answer is known: for x on a node line, LME is a product
// of one-dimensional functions, and close to the wall the one across it is
// N_1 = eps/h + O(eps^2), N_0 = 1 - N_1, with gradients +-1/h + O(eps). Central
// differences cannot be used here: they need a step below eps, and round-off
// 1e-16/step then exceeds 1e-7 for eps < 1e-9 h.
TYPED_TEST(Lme, LimitAtTheWallIsLinear)
{
  constexpr int dim = TypeParam::value;
  for (const double gamma : gammas)
    for (const double eps : {1e-6, 1e-8, 1e-9, 1e-10, 0.})
      {
        Point<dim> x;
        for (int d = 1; d < dim; ++d)
          x[d] = 2.3;
        x[0]             = eps;
        const auto nodes = grid_near(x, 1., gamma);
        const auto v     = evaluate(nodes, x);
        double     N[2] = {}, grad[2] = {};
        for (unsigned int a = 0; a < nodes.n; ++a)
          if (nodes.x[0][a] < 1.5)
            {
              N[nodes.x[0][a] > 0.5] += v.N[a];
              grad[nodes.x[0][a] > 0.5] += v.grad[a];
            }
        const double tolerance = 1e-7 + 5. * eps; // 1e-7: the shift (L8)
        EXPECT_NEAR(grad[0], -1., tolerance);
        EXPECT_NEAR(grad[1], 1., tolerance);
        EXPECT_NEAR(N[1], eps, 5. * eps * eps + 1e-15);
      }
}


// Where differences can be taken: the step is a tenth of the distance, so
// truncation is of order (step/h)^2 and round-off of order 1e-15 h/step. The
// tolerance 1e-7 holds until the latter exceeds it at eps = 1e-7 h.
TYPED_TEST(Lme, GradientNearTheWallAgainstDifferences)
{
  constexpr int dim = TypeParam::value;
  for (const double gamma : gammas)
    for (const double eps : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6})
      {
        Point<dim> x;
        for (int d = 0; d < dim; ++d)
          x[d] = (d == 1 ? 2.3 : eps);
        const auto nodes = grid_near(x, 1., gamma);
        const auto v     = evaluate(nodes, x);
        EXPECT_LT(difference_to_fd(nodes, x, v, std::min(1e-5, .1 * eps)), 1e-7)
          << eps;
      }
}


TYPED_TEST(Lme, OutsideIsRefused)
{
  constexpr int dim = TypeParam::value;
  for (const double gamma : gammas)
    for (const double distance : {1e-11, 1e-9, 1e-6, 1e-2, 1., 100.})
      for (int n_walls = 1; n_walls <= dim; ++n_walls)
        {
          Point<dim> near;
          for (int d = 0; d < dim; ++d)
            near[d] = (d < n_walls ? 0. : 2.3);
          const auto nodes = grid_near(near, 1., gamma);
          Point<dim> x     = near;
          for (int d = 0; d < n_walls; ++d)
            x[d] = -distance;
          try
            {
              evaluate(nodes, x);
              ADD_FAILURE() << "accepted " << x << ", gamma " << gamma;
            }
          catch (const OutsideHull<dim> &failure)
            {
              EXPECT_EQ(failure.point, x);
            }
        }
}


TYPED_TEST(Lme, RoundOffOutsideIsAccepted)
{
  constexpr int dim = TypeParam::value;
  for (const double gamma : gammas)
    {
      Point<dim> x;
      for (int d = 1; d < dim; ++d)
        x[d] = 2.3;
      x[0]             = -1e-15;
      const auto nodes = grid_near(x, 1., gamma);
      expect_identities(nodes, x, evaluate(nodes, x), 1e-7);
    }
}


TYPED_TEST(Lme, TooFewOrFlatNodes)
{
  constexpr int           dim = TypeParam::value;
  std::vector<Point<dim>> points(dim);
  LmeNodes<dim>           nodes;
  nodes.reinit(points, std::vector<double>(dim, 1.), 1.);
  EXPECT_THROW(evaluate(nodes, Point<dim>()), OutsideHull<dim>);

  points.resize(6);
  for (int a = 0; a < 6; ++a)
    points[a][0] = a;
  nodes.reinit(points, std::vector<double>(6, 1.), 1.);
  Point<dim> x;
  x[0] = 2.2;
  EXPECT_THROW(evaluate(nodes, x), OutsideHull<dim>);
}


// A useless start must not change the answer or throw.
TYPED_TEST(Lme, AnyStart)
{
  constexpr int dim = TypeParam::value;
  for (const double gamma : gammas)
    for (const auto &x : random_points<dim>(20, 0.001, 2.))
      {
        const auto nodes = grid_near(x, 1., gamma);
        const auto v     = evaluate(nodes, x);
        for (const double wrong : {-1., 10., -300., 1e5})
          {
            Tensor<1, dim> start;
            start[0]     = wrong;
            start[1]     = -0.3 * wrong;
            const auto w = evaluate(nodes, x, start);
            expect_identities(nodes, x, w, 1e-7);
            for (unsigned int a = 0; a < nodes.n; ++a)
              EXPECT_NEAR(v.N[a], w.N[a], 1e-12);
          }
        EXPECT_LE(evaluate(nodes, x, v.lambda).n_steps, 1u);
      }
}


// lme_evaluate_points() against lme_evaluate(); the tolerance is for grad N.
template <int dim>
void
expect_equal(const LmeNodes<dim> &nodes,
             const Values<dim>   &v,
             const Values<dim>   &w,
             const double         tolerance)
{
  for (unsigned int a = 0; a < nodes.n_padded; ++a)
    {
      EXPECT_NEAR(v.N[a], w.N[a], 1e-12);
      for (unsigned int d = 0; d < dim; ++d)
        EXPECT_NEAR(nodes.h * v.grad[d * nodes.n_padded + a],
                    nodes.h * w.grad[d * nodes.n_padded + a],
                    tolerance);
    }
}


/// A box of 11 x 9 nodes or 7 x 5 x 3; rows are longer than a SIMD vector in
/// 2D, and not a multiple of its length.
template <int dim>
LmeNodes<dim>
make_box(const double h, const double gamma)
{
  std::array<unsigned int, dim> size;
  Point<dim>                    origin;
  for (unsigned int d = 0; d < dim; ++d)
    {
      size[d]   = (dim == 2 ? 11 : 7) - 2 * d;
      origin[d] = 0.7 - d;
    }
  return LmeNodes<dim>::make_box(origin, h, size, gamma / (h * h));
}


TYPED_TEST(Lme, PointsOfABox)
{
  constexpr int dim = TypeParam::value;
  const double  h   = 0.1;
  for (const double gamma : gammas)
    {
      const auto box = make_box<dim>(h, gamma);
      auto       x   = random_points<dim>(203, 0.01, 1.99);
      for (auto &p : x)
        p = box.box_origin + h * Tensor<1, dim>(p);
      const auto v = evaluate_points(box, x);
      for (unsigned int q = 0; q < x.size(); ++q)
        {
          const auto w = evaluate(box, x[q]);
          expect_identities(box, x[q], v[q], gradient_accuracy);
          EXPECT_LT((v[q].lambda - w.lambda).norm() * h, 1e-9);
          expect_equal(box, v[q], w, gradient_accuracy);
          // A warm start passes between the kernels.
          EXPECT_LE(evaluate(box, x[q], v[q].lambda).n_steps, 1u);
        }
      EXPECT_LE(v[0].n_steps, 5u * x.size());
      EXPECT_LE(evaluate_points(box, x, v)[0].n_steps, 2u * x.size());
    }
  EXPECT_TRUE(
    evaluate_points(make_box<dim>(h, 1.8), std::vector<Point<dim>>()).empty());
}


// Each point alone gives the same bits as with others, whatever they are.
TYPED_TEST(Lme, PointsOfABoxDoNotAffectEachOther)
{
  constexpr int dim = TypeParam::value;
  const auto    box = make_box<dim>(1., 3.);
  auto          x   = random_points<dim>(21, 0., 2.);
  for (auto &p : x)
    p += box.box_origin;
  x[3][0]      = box.box_origin[0];
  const auto v = evaluate_points(box, x);
  for (unsigned int q = 0; q < x.size(); ++q)
    {
      const auto w = evaluate_points(box, std::vector<Point<dim>>{x[q]})[0];
      EXPECT_EQ(v[q].lambda, w.lambda);
      for (unsigned int a = 0; a < box.n_padded; ++a)
        EXPECT_EQ(v[q].N[a], w.N[a]);
      for (unsigned int i = 0; i < dim * box.n_padded; ++i)
        EXPECT_EQ(v[q].grad[i], w.grad[i]);
    }
}


// Towards the walls, edges and corners of the box, both ends; beside them a
// point inside. The kernels differ by what each may differ from the truth.
TYPED_TEST(Lme, WallsOfABox)
{
  constexpr int dim = TypeParam::value;
  for (const double gamma : gammas)
    {
      const auto              box = make_box<dim>(1., gamma);
      std::vector<Point<dim>> x;
      for (int n_walls = 0; n_walls <= dim; ++n_walls)
        for (int power = 1; power <= 11; ++power)
          for (const bool far_end : {false, true})
            {
              const double eps = (power == 11 ? 0. : std::pow(10., -power));
              Point<dim>   p   = box.box_origin;
              for (int d = 0; d < dim; ++d)
                p[d] += (d >= n_walls ? .45 * (box.box_size[d] - 1.)
                         : far_end    ? box.box_size[d] - 1. - eps
                                      : eps);
              x.push_back(p);
            }
      const auto v = evaluate_points(box, x);
      for (unsigned int q = 0; q < x.size(); ++q)
        {
          // 1e-7: round-off 1e-16 h/eps, the origin not being at zero.
          expect_identities(box, x[q], v[q], 1e-7);
          expect_equal(box, v[q], evaluate(box, x[q]), 1e-7);
        }
    }
}


TYPED_TEST(Lme, OutsideOfABoxIsRefused)
{
  constexpr int dim = TypeParam::value;
  for (const double gamma : gammas)
    for (const double distance : {1e-11, 1e-9, 1e-6, 1e-2, 1., 100.})
      for (int n_walls = 1; n_walls <= dim; ++n_walls)
        {
          std::array<unsigned int, dim> size;
          size.fill(6);
          const auto box =
            LmeNodes<dim>::make_box(Point<dim>(), 1., size, gamma);
          auto x = random_points<dim>(11, 1., 4.);
          for (int d = 0; d < n_walls; ++d)
            x[9][d] = -distance;
          try
            {
              evaluate_points(box, x);
              ADD_FAILURE() << "accepted " << x[9] << ", gamma " << gamma;
            }
          catch (const OutsideHull<dim> &failure)
            {
              EXPECT_EQ(failure.point, x[9]);
            }
          for (int d = 0; d < n_walls; ++d)
            x[9][d] = -1e-15;
          expect_identities(box, x[9], evaluate_points(box, x)[9], 1e-7);
        }
}


// Whatever the length of the rows, nothing is left over from neighbours.
TEST(LmeBox, RowsOfAnyLength)
{
  for (unsigned int n_x = 2; n_x <= 18; ++n_x)
    for (const unsigned int n_y : {2, 3, 8})
      {
        const auto box =
          LmeNodes<2>::make_box(Point<2>(), 1., {{n_x, n_y}}, 1.);
        const Point<2> x(0.3 * n_x, 0.4);
        const auto     v = evaluate_points(box, std::vector<Point<2>>{x})[0];
        expect_identities(box, x, v, gradient_accuracy);
        expect_equal(box, v, evaluate(box, x), gradient_accuracy);
      }
}


// Long lines, for which the recurrence would leave the range of doubles, and
// lists that are no boxes go to the general kernel.
TEST(LmeBox, OtherLists)
{
  const auto long_box = LmeNodes<2>::make_box(Point<2>(), 1., {{60, 5}}, 1.8);
  const std::vector<Point<2>> x = {Point<2>(0.4, 2.2),
                                   Point<2>(30.3, 2.2),
                                   Point<2>(58.8, 2.2)};
  const auto                  v = evaluate_points(long_box, x);
  for (unsigned int q = 0; q < x.size(); ++q)
    expect_identities(long_box, x[q], v[q], gradient_accuracy);

  const Point<2> y(3.6, 3.3);
  const auto     nodes = graded<2>(1.8);
  const auto     w     = evaluate_points(nodes, std::vector<Point<2>>{y})[0];
  expect_identities(nodes, y, w, gradient_accuracy);
  EXPECT_EQ(w.n_steps, evaluate(nodes, y).n_steps);
}


TEST(LmeNodes, Layout)
{
  const auto nodes =
    LmeNodes<3>::make_box(Point<3>(1, 2, 3), .5, {{2, 3, 4}}, 7.);
  EXPECT_EQ(nodes.n, 24u);
  EXPECT_EQ(nodes.n_padded, 24u);
  EXPECT_EQ(lme_padded(17), 24u);
  const unsigned int a = 1 + 2 * (2 + 3 * 3);
  EXPECT_EQ(node(nodes, a), Point<3>(1.5, 3., 4.5));
  EXPECT_EQ(nodes.beta[a], 7.);
  EXPECT_NEAR(lme_support_radius(2., 1.8, 1e-6), 2. * 2.7704, 1e-4);
}


// No gradients asked: the same N, and the wall needs them inside.
TEST(LmeNodes, WithoutGradients)
{
  const Point<2>        x(0., 2.3);
  const auto            nodes = grid_near(x, 1., 1.8);
  AlignedVector<double> N(nodes.n_padded);
  Tensor<1, 2>          lambda;
  lme_evaluate(nodes, x, lambda, N.data(), nullptr);
  const auto v = evaluate(nodes, x);
  for (unsigned int a = 0; a < nodes.n_padded; ++a)
    EXPECT_EQ(N[a], v.N[a]);
}
