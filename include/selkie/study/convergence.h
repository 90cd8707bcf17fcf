#pragma once

#include <string>
#include <vector>

namespace selkie
{
  /// The cost and the error of one member that was run to its end.
  struct CostAndError
  {
    double size  = 0; ///< h, or whatever goes to zero
    double time  = 0; ///< s
    double error = 0;
  };

  /// Orders between neighbours in the order of decreasing size,
  /// log(e_i / e_{i+1}) / log(h_i / h_{i+1}): one less than there are points.
  std::vector<double>
  observed_orders(std::vector<CostAndError> points);

  /// The order over the asymptotic range: the slope of the line through the
  /// finest points, as many (at least three) as have neighbouring orders within
  /// 0.3 of the finest one's. NaN if there are fewer.
  double
  fitted_order(std::vector<CostAndError> points);

  /// Whether each point is on the Pareto front: no other is as good and as
  /// cheap.
  std::vector<bool>
  pareto_front(const std::vector<CostAndError> &points);

  /**
   * The time in which a series reaches an error: between the cheapest member
   * that does and the best cheaper one, linear in the logarithms; of the first
   * member if that does already. NaN if none reaches it.
   */
  double
  time_to_reach(std::vector<CostAndError> points, const double error);
} // namespace selkie
