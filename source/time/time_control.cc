#include <selkie/base/text.h>
#include <selkie/time/time_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace selkie
{
  TimeControl::TimeControl(const TimeParameters &parameters,
                           const double          h,
                           const double          sound_speed)
    : parameters(parameters)
    , h(h)
    , acoustic_step(std::numeric_limits<double>::infinity())
  {
    if (parameters.acoustic_cfl > 0. && sound_speed > 0.)
      acoustic_step = parameters.acoustic_cfl * h / sound_speed;
    s.allowed  = parameters.step;
    s.by_error = parameters.step;
    limit(0.);
  }

  bool
  TimeControl::at_end() const
  {
    return s.t >= parameters.end_time * (1. - 1e-12);
  }

  bool
  TimeControl::cut()
  {
    const double smallest = parameters.smallest_step > 0.
                              ? parameters.smallest_step
                              : parameters.step / 1024.;
    if (0.5 * s.dt < smallest)
      return false;
    s.dt      = 0.5 * s.dt;
    s.allowed = s.dt;
    s.good    = 0;
    s.rule    = failure;
    ++s.n_cuts;
    return true;
  }

  void
  TimeControl::advance(const double speed, const double time_error)
  {
    s.t += s.dt;
    ++s.n;
    ++s.ruled[s.rule];
    if (++s.good >= parameters.easy_steps)
      {
        s.allowed = std::min(1.5 * s.allowed, parameters.step);
        s.good    = 0;
      }
    // The error of a step goes with its third power; changes are damped.
    if (parameters.largest_error > 0.)
      s.by_error =
        s.dt * std::clamp(0.9 * std::cbrt(parameters.largest_error * h /
                                          std::max(time_error, 1e-300)),
                          0.5,
                          1.5);
    limit(speed);
  }

  void
  TimeControl::limit(const double speed)
  {
    s.dt               = parameters.step;
    s.rule             = scene_step;
    const auto at_most = [this](const double dt, const Rule rule) {
      if (dt < s.dt)
        {
          s.dt   = dt;
          s.rule = rule;
        }
    };
    at_most(s.allowed, failure);
    if (speed > 0.)
      at_most(parameters.max_move * h / speed, advective);
    at_most(acoustic_step, acoustic);
    at_most(s.by_error, error);
    const double left = parameters.end_time - s.t;
    if (s.dt >= left * (1. - 1e-6)) // no sliver of a step at the end
      {
        s.dt   = left;
        s.rule = end_time;
      }
  }

  void
  TimeControl::restore(const State &state)
  {
    s = state;
    if (s.rule == end_time && s.t + s.dt < parameters.end_time * (1. - 1e-12))
      limit(0.);
  }

  std::string
  TimeControl::rules() const
  {
    static const char *const names[n_rules] = {"Step",
                                               "advective CFL",
                                               "acoustic CFL",
                                               "estimated error",
                                               "failures",
                                               "end time"};
    const double all = std::accumulate(s.ruled.begin(), s.ruled.end(), 0u);
    std::string  text;
    for (unsigned int r = 0; r < n_rules; ++r)
      if (s.ruled[r] > 0)
        text += format("%s%s %.0f %%",
                       text.empty() ? "" : ", ",
                       names[r],
                       100. * s.ruled[r] / all);
    return text;
  }
} // namespace selkie
