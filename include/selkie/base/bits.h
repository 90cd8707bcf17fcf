#pragma once

namespace selkie
{
  /// Calls see(i) for every bit i of @p bits that is set, the lowest first.
  template <typename See>
  void
  for_each_bit(const unsigned int bits, const See &see)
  {
    for (unsigned int i = 0; i < 32 && (bits >> i) != 0; ++i)
      if ((bits >> i) & 1u)
        see(i);
  }
} // namespace selkie
