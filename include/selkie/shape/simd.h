#pragma once

#include <cstdint>
#include <experimental/simd>

/**
 * @file
 * Vectors of doubles for the LME kernels. GCC 12's own exp for these types is
 * a scalar loop, hence vexp. Files that include this header must not be
 * compiled with -ffast-math: it folds the rounding in vexp away.
 */
namespace selkie
{
  namespace simd
  {
    namespace stdx = std::experimental;

    /// As many lanes as the machine has (2, 4 or 8).
    using Native = stdx::native_simd<double>;

    /// Four lanes, whatever the machine has.
    using Four = stdx::simd<double, stdx::simd_abi::deduce_t<double, 4>>;

    /// The exponents that vexp is exact for; it clamps others to these ends.
    /// The lower end is high enough for products with coordinates to stay clear
    /// of denormal numbers, which are slow.
    constexpr double min_exponent = -600., max_exponent = 700.;

    /// exp(x), lane by lane; relative error below 5e-16. x = k ln 2 + r with
    /// |r| < ln 2 / 2, the Taylor polynomial of degree 13 in r (even and odd
    /// powers apart: half the latency), then k is added to the exponent's bits.
    template <class V>
    inline V
    vexp(const V &argument)
    {
      using I = stdx::rebind_simd_t<std::int64_t, V>;
      const V x =
        stdx::max(V(min_exponent), stdx::min(V(max_exponent), argument));
      const V magic(6755399441055744.); // 1.5 * 2^52: rounds to integer
      V       k    = x * V(1.4426950408889634074) + magic;
      const I bits = __builtin_bit_cast(I, k);
      k -= magic;
      const V r = (x - k * V(6.93147180369123816490e-01)) -
                  k * V(1.90821492927058770002e-10);
      const V s = r * r;
      V       even(1. / 479001600.), odd(1. / 6227020800.);
      for (const double c :
           {1. / 3628800., 1. / 40320., 1. / 720., 1. / 24., 1. / 2., 1.})
        even = even * s + V(c);
      for (const double c :
           {1. / 39916800., 1. / 362880., 1. / 5040., 1. / 120., 1. / 6., 1.})
        odd = odd * s + V(c);
      const V p = odd * r + even;
      return __builtin_bit_cast(V, I(__builtin_bit_cast(I, p) + (bits << 52)));
    }

    /// exp(t) for |t| < 0.01 by its Taylor polynomial of degree 5; relative
    /// error below 2e-15.
    template <class V>
    inline V
    vexp_small(const V &t)
    {
      V p(1. / 120.);
      for (const double c : {1. / 24., 1. / 6., 1. / 2., 1., 1.})
        p = p * t + V(c);
      return p;
    }

    /// 0, 1, 2, ... in the lanes.
    template <class V>
    inline V
    lane_numbers()
    {
      return V([](const auto i) { return static_cast<double>(i); });
    }
  } // namespace simd
} // namespace selkie
