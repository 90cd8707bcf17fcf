#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

/**
 * @file
 * Vectors of doubles for the LME kernels, by the vector extension of GCC and
 * Clang: arithmetic with doubles, comparison and ?: work lane by lane, and the
 * compiler lowers them to what the machine has. Files that include this header
 * must not be compiled with -ffast-math: it folds the rounding in vexp away.
 *
 * std::experimental::simd of GCC 12 was tried first: its broadcasts stayed
 * function calls at deal.II's -O2, its exp is a scalar loop, and the code was
 * longer at the same speed.
 */
namespace selkie
{
  namespace simd
  {
    typedef double Two __attribute__((vector_size(16)));
    typedef double Four __attribute__((vector_size(32)));
    typedef double Eight __attribute__((vector_size(64)));
    typedef float  EightFloats __attribute__((vector_size(32)));

    /// As many lanes as the machine has.
#if defined(__AVX512F__)
    using Native = Eight;
#elif defined(__AVX__)
    using Native = Four;
#else
    using Native = Two;
#endif

    /// The number of lanes.
    template <class V>
    constexpr unsigned int n_lanes = sizeof(V) / sizeof(double);

    /// For doubles or floats.
    template <typename Number>
    using NativeOf =
      std::conditional_t<std::is_same_v<Number, float>, EightFloats, Native>;

    /// x in all lanes.
    template <class V>
    inline V
    all(const double x)
    {
      return x - V{};
    }

    /// As many numbers as V has, from any address.
    template <class V, typename Number>
    inline V
    load(const Number *from)
    {
      V v;
      std::memcpy(&v, from, sizeof(V));
      return v;
    }

    template <class V>
    inline void
    store(const V &v, double *to)
    {
      std::memcpy(to, &v, sizeof(V));
    }

    template <class V>
    inline V
    min(const V &a, const V &b)
    {
      return a < b ? a : b;
    }

    template <class V>
    inline V
    max(const V &a, const V &b)
    {
      return a > b ? a : b;
    }

    /// The sum of the lanes.
    inline double
    sum(const Two &v)
    {
      return v[0] + v[1];
    }

    inline double
    sum(const Four &v)
    {
      return sum(__builtin_shufflevector(v, v, 0, 1) +
                 __builtin_shufflevector(v, v, 2, 3));
    }

    inline double
    sum(const Eight &v)
    {
      return sum(__builtin_shufflevector(v, v, 0, 1, 2, 3) +
                 __builtin_shufflevector(v, v, 4, 5, 6, 7));
    }

    inline float
    sum(const EightFloats &v)
    {
      const auto half = __builtin_shufflevector(v, v, 0, 1, 2, 3) +
                        __builtin_shufflevector(v, v, 4, 5, 6, 7);
      return (half[0] + half[2]) + (half[1] + half[3]);
    }

    /// The lanes of two vectors by turns, in two vectors.
    inline void
    interleave(const Two &a, const Two &b, Two &first, Two &second)
    {
      first  = __builtin_shufflevector(a, b, 0, 2);
      second = __builtin_shufflevector(a, b, 1, 3);
    }

    inline void
    interleave(const Four &a, const Four &b, Four &first, Four &second)
    {
      first  = __builtin_shufflevector(a, b, 0, 4, 1, 5);
      second = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    }

    inline void
    interleave(const Eight &a, const Eight &b, Eight &first, Eight &second)
    {
      first  = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
      second = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
    }

    /// The largest lane (not meant to be fast).
    template <class V>
    inline double
    largest_lane(const V &v)
    {
      double result = v[0];
      for (unsigned int i = 1; i < n_lanes<V>; ++i)
        result = (v[i] > result ? v[i] : result);
      return result;
    }

    /// v in the first n lanes, 0 in the others.
    template <class V>
    inline V
    first_lanes(const V &v, const double n)
    {
      V number;
      for (unsigned int i = 0; i < n_lanes<V>; ++i)
        number[i] = i;
      return number < n ? v : V{};
    }

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
      using I            = decltype(argument < argument); // 64-bit integers
      constexpr double c = 6755399441055744.; // 1.5 * 2^52: rounds to integer
      const V          x =
        max(all<V>(min_exponent), min(all<V>(max_exponent), argument));
      V       k    = x * 1.4426950408889634074 + c;
      const I bits = reinterpret_cast<I>(k);
      k -= c;
      const V r =
        (x - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
      const V s    = r * r;
      V       even = s * (1. / 479001600.) + 1. / 3628800.;
      even         = even * s + 1. / 40320.;
      even         = even * s + 1. / 720.;
      even         = even * s + 1. / 24.;
      even         = even * s + 1. / 2.;
      even         = even * s + 1.;
      V odd        = s * (1. / 6227020800.) + 1. / 39916800.;
      odd          = odd * s + 1. / 362880.;
      odd          = odd * s + 1. / 5040.;
      odd          = odd * s + 1. / 120.;
      odd          = odd * s + 1. / 6.;
      odd          = odd * s + 1.;
      const V p    = odd * r + even;
      return reinterpret_cast<V>(reinterpret_cast<I>(p) + (bits << 52));
    }

    /// exp(t) for |t| < 0.01 by its Taylor polynomial of degree 5; relative
    /// error below 2e-15.
    template <class V>
    inline V
    vexp_small(const V &t)
    {
      return ((((t * (1. / 120.) + 1. / 24.) * t + 1. / 6.) * t + 1. / 2.) * t +
              1.) *
               t +
             1.;
    }
  } // namespace simd
} // namespace selkie
