#pragma once

#include <selkie/shape/simd.h>

#include <cstddef>

namespace selkie
{
  /**
   * Products of n rows with a vector, run by run of their columns: several
   * entries at a time. The last ones of a run overlap those before them and
   * count only what is new; short runs go one by one. (Loops over the rows are
   * unrolled so that the sums stay in registers.)
   */
  template <unsigned int n_rows, typename Number>
  class RowProducts
  {
  public:
    RowProducts()
    {
#pragma GCC unroll 4
      for (unsigned int r = 0; r < n_rows; ++r)
        {
          sum[r]  = Lanes{};
          rest[r] = 0;
        }
    }

    /// @param values of the first row in this run
    /// @param stride from there to those of the next row
    /// @param x of its first column
    void
    add(const Number      *values,
        const std::size_t  stride,
        const Number      *x,
        const unsigned int length)
    {
      if (length < width)
        {
          for (unsigned int k = 0; k < length; ++k)
#pragma GCC unroll 4
            for (unsigned int r = 0; r < n_rows; ++r)
              rest[r] += values[r * stride + k] * x[k];
          return;
        }
      unsigned int k = 0;
      for (; k + width <= length; k += width)
        add_lanes(values + k, stride, simd::load<Lanes>(x + k));
      if (k < length)
        add_lanes(values + length - width,
                  stride,
                  simd::load<Lanes>(x + length - width) *
                    simd::load<Lanes>(last.ones[length - k]));
    }

    Number
    operator[](const unsigned int r) const
    {
      return simd::sum(sum[r]) + rest[r];
    }

  private:
    using Lanes                         = simd::NativeOf<Number>;
    static constexpr unsigned int width = sizeof(Lanes) / sizeof(Number);

    void
    add_lanes(const Number *values, const std::size_t stride, const Lanes &x)
    {
#pragma GCC unroll 4
      for (unsigned int r = 0; r < n_rows; ++r)
        sum[r] += simd::load<Lanes>(values + r * stride) * x;
    }

    /// Ones in the last n lanes.
    struct Masks
    {
      constexpr Masks()
      {
        for (unsigned int n = 0; n < width; ++n)
          for (unsigned int k = width - n; k < width; ++k)
            ones[n][k] = 1;
      }

      Number ones[width][width] = {};
    };
    static constexpr Masks last = {};

    Lanes  sum[n_rows];
    Number rest[n_rows];
  };
} // namespace selkie
