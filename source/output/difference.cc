#include <selkie/output/difference.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  void
  DifferenceSums::add(const double weight,
                      const double difference,
                      const double value,
                      const double time)
  {
    add({weight * difference * difference,
         weight * value * value,
         difference,
         time,
         value});
  }


  void
  DifferenceSums::add(const DifferenceSums &other)
  {
    difference2 += other.difference2;
    value2 += other.value2;
    scale = std::max(scale, other.scale);
    if (other.largest > largest)
      {
        largest      = other.largest;
        largest_time = other.largest_time;
      }
  }


  Difference
  DifferenceSums::result(const std::string &source,
                         const std::string &quantity) const
  {
    Difference difference;
    difference.source       = source;
    difference.quantity     = quantity;
    difference.relative_L2  = difference2 > 0.
                                ? std::sqrt(difference2 / value2)
                                : 0.; // by IEEE rules infinite if A is 0
    difference.largest      = largest;
    difference.largest_time = largest_time;
    difference.scale        = scale;
    return difference;
  }
} // namespace selkie
