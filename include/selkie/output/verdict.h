#pragma once

#include <selkie/scene/scene.h>

#include <limits>
#include <string>
#include <vector>

namespace selkie
{
  /**
   * The audit's verdict on a run: how far each figure went, and when it first
   * passed its limits.
   */
  class Verdict
  {
  public:
    enum class Grade
    {
      pass,
      warn,
      fail
    };

    struct Row
    {
      std::string figure;
      AuditLimit  limit;
      bool        from_below = false; ///< whether small values are bad
      double      worst      = 0;
      /// First time (s) beyond each of the two limits; NaN: never.
      std::array<double, 2> first{{std::numeric_limits<double>::quiet_NaN(),
                                   std::numeric_limits<double>::quiet_NaN()}};

      Grade
      grade() const;
    };

    /// Takes note of a figure at time @p t (s). Values that are not finite are
    /// beyond every limit.
    void
    look(const std::string &figure,
         const double       value,
         const AuditLimit  &limit,
         const double       t,
         const bool         from_below = false);

    /// The worst of all figures.
    Grade
    grade() const;

    const std::vector<Row> &
    rows() const
    {
      return table;
    }

    /// Goes on with what an earlier part of the run has noted.
    void
    restore(const std::vector<Row> &rows)
    {
      table = rows;
    }

    /// One line: "pass", or each figure beyond a limit, with its time.
    std::string
    text() const;

  private:
    std::vector<Row> table;
  };

  std::string
  to_string(const Verdict::Grade grade);
} // namespace selkie
