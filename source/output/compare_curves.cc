#include <selkie/output/compare_curves.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  namespace
  {
    const std::string time_column = "time (s)";

    /// The part of a curve's rows that lies in the time of both.
    struct CommonTimes
    {
      std::size_t begin = 0, end = 0; ///< rows of A
    };

    CommonTimes
    common_times(const std::vector<double> &a, const std::vector<double> &b)
    {
      if (a.empty() || b.empty())
        return {};
      // Two runs may end at times that differ by round-off.
      const double slack =
        1e-9 * std::max(std::abs(a.back()), std::abs(b.back()));
      const auto begin =
        std::lower_bound(a.begin(), a.end(), b.front() - slack);
      const auto end = std::upper_bound(begin, a.end(), b.back() + slack);
      return {static_cast<std::size_t>(begin - a.begin()),
              static_cast<std::size_t>(end - a.begin())};
    }

    /// The share of a row in an integral over time.
    double
    trapezoidal_weight(const std::vector<double> &times,
                       const CommonTimes         &rows,
                       const std::size_t          i)
    {
      if (rows.end - rows.begin == 1)
        return 1.;
      const std::size_t before = i == rows.begin ? i : i - 1;
      const std::size_t after  = i + 1 == rows.end ? i : i + 1;
      return (times[after] - times[before]) / 2.;
    }
  } // namespace


  std::vector<Difference>
  compare_curves(const std::string                              &source,
                 const TableFile                                &a,
                 const TableFile                                &b,
                 const std::function<bool(const std::string &)> &wanted)
  {
    const auto *const times_a = a.find(time_column);
    const auto *const times_b = b.find(time_column);
    if (!times_a || !times_b)
      return {};
    const CommonTimes rows = common_times(*times_a, *times_b);

    std::vector<Difference> differences;
    for (std::size_t c = 0; c < a.columns.size(); ++c)
      {
        const std::string &column   = a.columns[c];
        const auto *const  values_b = b.find(column);
        if (column == time_column || !values_b || !wanted(column))
          continue;
        DifferenceSums sums;
        bool           any = false;
        for (std::size_t i = rows.begin; i < rows.end; ++i)
          {
            const double t       = (*times_a)[i];
            const double value_a = a.values[c][i];
            const double value_b = interpolate(*times_b, *values_b, t);
            if (!std::isfinite(value_a) || !std::isfinite(value_b))
              continue;
            any = true;
            sums.add(trapezoidal_weight(*times_a, rows, i),
                     std::abs(value_a - value_b),
                     std::abs(value_a),
                     t);
          }
        if (any)
          differences.push_back(sums.result(source, column));
      }
    return differences;
  }


  bool
  is_physical(const std::string &column)
  {
    if (column == "min J" || column == "max J")
      return true;
    return !unit_of_column(column).empty() && column != time_column &&
           column != "dt (s)";
  }
} // namespace selkie
