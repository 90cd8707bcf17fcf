#include <selkie/base/text.h>
#include <selkie/output/verdict.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  std::string
  to_string(const Verdict::Grade grade)
  {
    return grade == Verdict::Grade::pass   ? "pass"
           : grade == Verdict::Grade::warn ? "warn"
                                           : "fail";
  }


  Verdict::Grade
  Verdict::Row::grade() const
  {
    return !std::isnan(first[1])   ? Grade::fail
           : !std::isnan(first[0]) ? Grade::warn
                                   : Grade::pass;
  }


  void
  Verdict::look(const std::string &figure,
                const double       value,
                const AuditLimit  &limit,
                const double       t,
                const bool         from_below)
  {
    auto row =
      std::find_if(table.begin(), table.end(), [&figure](const Row &other) {
        return other.figure == figure;
      });
    if (row == table.end())
      row = table.insert(row, Row{figure, limit, from_below, value});
    const auto beyond = [from_below, value](const double bound) {
      return !(from_below ? value >= bound : value <= bound);
    };
    if (beyond(row->worst))
      row->worst = value;
    for (unsigned int k = 0; k < 2; ++k)
      if (limit[k] > 0. && beyond(limit[k]) && std::isnan(row->first[k]))
        row->first[k] = t;
  }


  Verdict::Grade
  Verdict::grade() const
  {
    Grade worst = Grade::pass;
    for (const Row &row : table)
      worst = std::max(worst, row.grade());
    return worst;
  }


  std::string
  Verdict::text() const
  {
    std::string result = to_string(grade());
    for (const Row &row : table)
      if (row.grade() != Grade::pass)
        {
          const unsigned int k = row.grade() == Grade::fail ? 1 : 0;
          result += format("%s %s %.2g (%s %.2g from t = %.4g s on)",
                           result.find(':') == std::string::npos ? ":" : ",",
                           row.figure.c_str(),
                           row.worst,
                           row.from_below ? "below" : "above",
                           row.limit[k],
                           row.first[k]);
        }
    return result;
  }
} // namespace selkie
