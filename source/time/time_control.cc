#include <selkie/time/time_control.h>

#include <algorithm>

namespace selkie
{
  TimeControl::TimeControl(const TimeParameters &parameters, const double h)
    : parameters(parameters)
    , h(h)
    , allowed(parameters.step)
  {
    limit(0.);
  }

  bool
  TimeControl::at_end() const
  {
    return t >= parameters.end_time * (1. - 1e-12);
  }

  bool
  TimeControl::cut()
  {
    const double smallest = parameters.smallest_step > 0.
                              ? parameters.smallest_step
                              : parameters.step / 1024.;
    if (0.5 * dt < smallest)
      return false;
    dt      = 0.5 * dt;
    allowed = dt;
    good    = 0;
    ++n_cuts;
    return true;
  }

  void
  TimeControl::advance(const double speed)
  {
    t += dt;
    ++n;
    if (++good >= parameters.easy_steps)
      {
        allowed = std::min(1.5 * allowed, parameters.step);
        good    = 0;
      }
    limit(speed);
  }

  void
  TimeControl::limit(const double speed)
  {
    dt = allowed;
    if (speed * dt > parameters.max_move * h)
      dt = parameters.max_move * h / speed;
    const double left = parameters.end_time - t;
    if (dt >= left * (1. - 1e-6)) // no sliver of a step at the end
      dt = left;
  }
} // namespace selkie
