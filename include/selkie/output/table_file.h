#pragma once

#include <string>
#include <vector>

namespace selkie
{
  /// A CSV file of numbers, as Statistics writes it.
  struct TableFile
  {
    std::string                      path;
    std::vector<std::string>         columns; ///< their names, with units
    std::vector<std::vector<double>> values;  ///< by column

    /// The values of a column; null if there is none of that name.
    const std::vector<double> *
    find(const std::string &column) const;
  };

  /// @throw SceneError if the file cannot be read, a row is longer or shorter
  /// than the header, or a value is no number.
  TableFile
  read_table(const std::string &path);

  /**
   * A curve between its points, linearly.
   * @param times ascending (s), as many as values
   * @param t within the times; outside of them (by round-off) the nearest
   * end's value is taken
   */
  double
  interpolate(const std::vector<double> &times,
              const std::vector<double> &values,
              const double               t);

  /// The unit in a column's name, "m/s" of "velocity x (m/s)"; empty if none.
  std::string
  unit_of_column(const std::string &column);
} // namespace selkie
