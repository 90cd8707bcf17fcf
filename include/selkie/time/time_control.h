#pragma once

#include <selkie/scene/scene.h>

#include <array>
#include <string>

namespace selkie
{
  /**
   * The time and its step: the scene's step, smaller while points would move
   * more than `max_move` cells, while sound would travel more than
   * `acoustic_cfl` cells or while the estimated error of a step is larger than
   * `largest_error` (the last two on request); halved after a failure, and
   * growing again after `easy_steps` good ones. The last step ends at the end
   * time exactly.
   */
  class TimeControl
  {
  public:
    /// What made a step as small as it is.
    enum Rule : unsigned int
    {
      scene_step,
      advective, ///< points move at most max_move cells
      acoustic,
      error,
      failure, ///< a step was cut
      end_time
    };
    static constexpr unsigned int n_rules = 6;

    /// All that changes in the course of a run: for checkpoints.
    struct State
    {
      double       t = 0, dt = 0; ///< s; dt of the next step
      double       allowed  = 0;  ///< after failures (s)
      double       by_error = 0;  ///< by the estimate (s)
      unsigned int n = 0, n_cuts = 0, good = 0;
      Rule         rule = scene_step;            ///< of the next step
      std::array<unsigned int, n_rules> ruled{}; ///< steps done, by rule
    };

    /// @param h smallest node spacing (m)
    /// @param sound_speed of the stiffest body (m/s)
    TimeControl(const TimeParameters &parameters,
                const double          h,
                const double          sound_speed);

    double
    now() const
    {
      return s.t;
    }

    double
    step() const
    {
      return s.dt;
    }

    /// Steps done.
    unsigned int
    number() const
    {
      return s.n;
    }

    /// Times that a step was cut after a failure.
    unsigned int
    cuts() const
    {
      return s.n_cuts;
    }

    bool
    at_end() const;

    double
    end() const
    {
      return parameters.end_time;
    }

    const State &
    state() const
    {
      return s;
    }

    /// Goes on from a state of an earlier run. If that one ended at an earlier
    /// end time, its last step, which that cut short, is forgotten.
    void
    restore(const State &state);

    /// What the steps done were ruled by: "Step 90 %, end time 10 %".
    std::string
    rules() const;

    /// After a failed step: half of it. False when it would become smaller than
    /// the smallest step.
    bool
    cut();

    /// After a good step.
    /// @param speed largest speed (m/s)
    /// @param time_error estimated for the step (m), or 0
    void
    advance(const double speed, const double time_error);

  private:
    void
    limit(const double speed);

    const TimeParameters parameters;
    const double         h;
    double               acoustic_step; ///< s; infinite without such a limit
    State                s;
  };
} // namespace selkie
