#pragma once

#include <selkie/drivers/outlook.h>

#include <algorithm>

namespace selkie
{
  /**
   * How long a run will take, told from its first steps. The very first ones,
   * which find patterns and start from rest, do not count; so many of the next
   * do that noise is small.
   */
  class Forecast
  {
  public:
    /// The first steps, that do not count.
    static constexpr unsigned int n_cold = 3;

    /// @param t_0,t_end where the run begins and is to end (s)
    /// @param wall_0 time spent before its first step (s)
    Forecast(const double   t_0,
             const double   t_end,
             const double   wall_0,
             const Outlook &outlook = Outlook())
      : outlook(outlook)
      , t_0(t_0)
      , t_end(t_end)
      , wall_0(wall_0)
      , warm_t(t_0)
      , warm_wall(wall_0)
      , t(t_0)
      , wall(wall_0)
    {}

    /// After each step: the time that it reached and what is spent now (s).
    void
    record(const double       t_now,
           const double       wall_now,
           const unsigned int newton_iterations)
    {
      t    = t_now;
      wall = wall_now;
      ++n;
      n_newton += n > n_cold ? newton_iterations : 0;
      if (n == n_cold)
        {
          warm_t    = t;
          warm_wall = wall;
        }
    }

    /// Whether enough steps were seen.
    bool
    ready() const
    {
      constexpr double enough = 0.25; // s
      return n >= 10 &&
             (wall - warm_wall > enough || t - t_0 > 0.05 * (t_end - t_0));
    }

    /// Of one of the first steps, without the very first (s).
    double
    step() const
    {
      return (wall - warm_wall) / (n > n_cold ? n - n_cold : n);
    }

    /// How many steps there will be.
    double
    steps() const
    {
      const double of_size =
        std::min(outlook.largest_step,
                 (t - warm_t) / (n > n_cold ? n - n_cold : n));
      return n + (t < t_end ? (t_end - t) / of_size : 0.);
    }

    /// What later steps cost, relative to the first ones: more than the outlook
    /// says where Newton needs one iteration so far, which rest and free flight
    /// do.
    double
    growth() const
    {
      const double newton = n > n_cold ? double(n_newton) / (n - n_cold) : 2.;
      return outlook.growth * (1. + 0.1 * std::max(0., 2. - newton));
    }

    /// Of the whole run (s).
    double
    total() const
    {
      return wall - wall_0 + growth() * (steps() - n) * step();
    }

  private:
    const Outlook outlook;
    const double  t_0, t_end, wall_0;
    double        warm_t, warm_wall, t, wall;
    unsigned int  n        = 0; ///< steps seen
    unsigned int  n_newton = 0; ///< iterations in them but the cold ones
  };
} // namespace selkie
