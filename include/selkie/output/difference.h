#pragma once

#include <limits>
#include <string>
#include <vector>

namespace selkie
{
  /// How a quantity of a run B differs from that of a run A.
  struct Difference
  {
    std::string source;   ///< e.g. "probe tip", "body plate"
    std::string quantity; ///< with its unit: "displacement (m)"

    /// Of the points compared (s); not a number: over all times.
    double time = std::numeric_limits<double>::quiet_NaN();

    double relative_L2  = 0; ///< |A - B| / |A|: 0 if both are 0, inf if A is
    double largest      = 0; ///< largest |A - B|, in the quantity's unit
    double largest_time = 0; ///< when it occurs (s)
    double scale        = 0; ///< largest |A|, in the quantity's unit
  };

  /// What relative and largest differences are summed from.
  struct DifferenceSums
  {
    double difference2 = 0, value2 = 0; ///< weighted sums of squares
    double largest = 0, largest_time = 0, scale = 0;

    /// @param weight of this value, e.g. its share of time or volume
    /// @param difference |A - B|
    /// @param value |A|
    void
    add(const double weight,
        const double difference,
        const double value,
        const double time);

    void
    add(const DifferenceSums &other);

    Difference
    result(const std::string &source, const std::string &quantity) const;
  };
} // namespace selkie
