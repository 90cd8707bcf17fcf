#pragma once

#include <fstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace selkie
{
  /**
   * A CSV table that grows by a row at a time: statistics.csv, with one row a
   * step, and the files of the probes. The first row fixes the columns and
   * their order. Units belong in the column's name; timings do not belong in
   * such a table: two runs of a scene give the same file.
   */
  class Statistics
  {
  public:
    /// Starts the file, in a folder that exists; one that is there goes on, in
    /// its columns. Only the root writes; on the
    /// other ranks all calls are harmless.
    /// @throw std::runtime_error, on the root, if it cannot be written.
    void
    open(const std::string &path, const bool root);

    /// Sets a value of the present row; whole numbers are written as such,
    /// others with the 17 digits that identify a double.
    /// @param column e.g. "kinetic energy (J)", without comma or quote
    template <typename Number>
    void
    set(const std::string &column, const Number value)
    {
      static_assert(std::is_arithmetic<Number>::value, "a number");
      if constexpr (std::is_integral<Number>::value)
        set_text(column, std::to_string(value));
      else
        set_text(column, full_precision(value));
    }

    /// Writes and flushes the row. A column that was not set is `nan`.
    /// @throw std::runtime_error, on the root, if the disk does not take it or
    /// the file is gone.
    void
    end_row();

  private:
    static std::string
    full_precision(const double value);

    void
    set_text(const std::string &column, const std::string &value);

    std::string   path;
    bool          root       = false;
    bool          has_header = false;
    std::ofstream file;

    std::vector<std::pair<std::string, std::string>> row; ///< column, value
    std::size_t next = 0; ///< where the next column is expected
  };

  /// The name of a column for one component, e.g. "momentum x (kg m/s)".
  std::string
  component_column(const std::string &quantity,
                   const unsigned int axis,
                   const std::string &unit);
} // namespace selkie
