#pragma once

#include <selkie/shape/simd.h>

#include <array>

namespace selkie
{
  /**
   * Products of n rows with a vector, run by run of their columns: eight
   * entries at a time. The last eight of a run overlap those before them and
   * count only what is new; short runs go one by one.
   */
  template <unsigned int n_rows, typename Number>
  class RowProducts
  {
  public:
    /// @param values of each row in this run
    /// @param x of its first column
    void
    add(const std::array<const Number *, n_rows> &values,
        const Number                             *x,
        const unsigned int                        length)
    {
      if (length < width)
        {
          for (unsigned int r = 0; r < n_rows; ++r)
            for (unsigned int k = 0; k < length; ++k)
              rest[r] += values[r][k] * x[k];
          return;
        }
      unsigned int k = 0;
      for (; k + width <= length; k += width)
        {
          const Lanes x_k = simd::load<Lanes>(x + k);
          for (unsigned int r = 0; r < n_rows; ++r)
            sum[r] += simd::load<Lanes>(values[r] + k) * x_k;
        }
      if (k < length)
        {
          const Lanes x_k = simd::load<Lanes>(x + length - width) *
                            simd::load<Lanes>(last[length - k]);
          for (unsigned int r = 0; r < n_rows; ++r)
            sum[r] += simd::load<Lanes>(values[r] + length - width) * x_k;
        }
    }

    Number
    operator[](const unsigned int r) const
    {
      return simd::sum(sum[r]) + rest[r];
    }

  private:
    using Lanes                         = simd::EightOf<Number>;
    static constexpr unsigned int width = 8;

    /// Ones in the last n lanes.
    static constexpr Number last[width][width] = {{0, 0, 0, 0, 0, 0, 0, 0},
                                                  {0, 0, 0, 0, 0, 0, 0, 1},
                                                  {0, 0, 0, 0, 0, 0, 1, 1},
                                                  {0, 0, 0, 0, 0, 1, 1, 1},
                                                  {0, 0, 0, 0, 1, 1, 1, 1},
                                                  {0, 0, 0, 1, 1, 1, 1, 1},
                                                  {0, 0, 1, 1, 1, 1, 1, 1},
                                                  {0, 1, 1, 1, 1, 1, 1, 1}};

    Lanes  sum[n_rows]  = {};
    Number rest[n_rows] = {};
  };
} // namespace selkie
