#include <selkie/study/convergence.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace selkie
{
  namespace
  {
    void
    sort_by_size(std::vector<CostAndError> &points)
    {
      std::sort(points.begin(), points.end(), [](const auto &a, const auto &b) {
        return a.size > b.size;
      });
    }
  } // namespace


  std::vector<double>
  observed_orders(std::vector<CostAndError> points)
  {
    sort_by_size(points);
    std::vector<double> orders;
    for (unsigned int i = 1; i < points.size(); ++i)
      orders.push_back(std::log(points[i - 1].error / points[i].error) /
                       std::log(points[i - 1].size / points[i].size));
    return orders;
  }


  double
  fitted_order(std::vector<CostAndError> points)
  {
    sort_by_size(points);
    const std::vector<double> orders = observed_orders(points);
    unsigned int              n      = 0; // neighbours that agree
    while (n < orders.size() &&
           std::abs(orders[orders.size() - 1 - n] - orders.back()) < 0.3)
      ++n;
    if (n < 2)
      return std::numeric_limits<double>::quiet_NaN();
    // Least squares for log e = a + order log h through the finest n + 1.
    double x = 0., y = 0., xx = 0., xy = 0.;
    for (unsigned int i = points.size() - 1 - n; i < points.size(); ++i)
      {
        const double h = std::log(points[i].size);
        const double e = std::log(points[i].error);
        x += h;
        y += e;
        xx += h * h;
        xy += h * e;
      }
    const double m = n + 1;
    return (m * xy - x * y) / (m * xx - x * x);
  }


  std::vector<bool>
  pareto_front(const std::vector<CostAndError> &points)
  {
    std::vector<bool> front;
    for (const auto &mine : points)
      front.push_back(
        std::none_of(points.begin(), points.end(), [&mine](const auto &other) {
          return (other.time < mine.time && other.error <= mine.error) ||
                 (other.time <= mine.time && other.error < mine.error);
        }));
    return front;
  }


  double
  time_to_reach(std::vector<CostAndError> points, const double error)
  {
    std::sort(points.begin(), points.end(), [](const auto &a, const auto &b) {
      return a.time < b.time;
    });
    const CostAndError *best = nullptr;
    for (const auto &point : points)
      {
        if (point.error <= error)
          {
            if (best == nullptr)
              return point.time;
            const double share = std::log(best->error / error) /
                                 std::log(best->error / point.error);
            return best->time * std::pow(point.time / best->time, share);
          }
        if (best == nullptr || point.error < best->error)
          best = &point;
      }
    return std::numeric_limits<double>::quiet_NaN();
  }
} // namespace selkie
