#pragma once

#include <selkie/output/difference.h>
#include <selkie/output/table_file.h>

#include <functional>
#include <string>
#include <vector>

namespace selkie
{
  /**
   * The differences of those columns that two tables over "time (s)" both
   * have, one for each. B is interpolated linearly on A's times within the
   * time that both cover; the norms are over that time, by the trapezoidal
   * rule (over one time alone: of the value there). Where a value is not a
   * number it is left out, and a column without any number as well.
   * @param wanted says which columns
   * @return empty if the tables have no time in common
   */
  std::vector<Difference>
  compare_curves(const std::string                              &source,
                 const TableFile                                &a,
                 const TableFile                                &b,
                 const std::function<bool(const std::string &)> &wanted);

  /// Whether a column of statistics.csv is physical: energies, momentum, mass,
  /// volume and the like, and no count or step size.
  bool
  is_physical(const std::string &column);
} // namespace selkie
