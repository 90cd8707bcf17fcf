#pragma once

#include <selkie/scene/scene.h>

namespace selkie
{
  /**
   * The time and its step: the scene's step, smaller while points would move
   * more than `max_move` cells, halved after a failure, and growing again after
   * `easy_steps` good ones. The last step ends at the end time exactly.
   */
  class TimeControl
  {
  public:
    /// @param h smallest node spacing (m)
    TimeControl(const TimeParameters &parameters, const double h);

    double
    now() const
    {
      return t;
    }

    double
    step() const
    {
      return dt;
    }

    /// Steps done.
    unsigned int
    number() const
    {
      return n;
    }

    /// Times that a step was cut after a failure.
    unsigned int
    cuts() const
    {
      return n_cuts;
    }

    bool
    at_end() const;

    double
    end() const
    {
      return parameters.end_time;
    }

    /// After a failed step: half of it. False when it would become smaller than
    /// the smallest step.
    bool
    cut();

    /// After a good step.
    /// @param speed largest speed (m/s)
    void
    advance(const double speed);

  private:
    void
    limit(const double speed);

    const TimeParameters parameters;
    const double         h;
    double               t = 0, dt = 0;
    double               allowed = 0; ///< after failures
    unsigned int         n = 0, n_cuts = 0, good = 0;
  };
} // namespace selkie
