#include <selkie/base/exceptions.h>
#include <selkie/time/newmark.h>

#include <cmath>
#include <sstream>

namespace selkie
{
  namespace
  {
    /// @p value, if it is positive and finite.
    double
    positive(const char *name, const double value)
    {
      if (value > 0. && std::isfinite(value))
        return value;
      std::ostringstream message;
      message << "Newmark's " << name << " is " << value
              << "; it must be positive and finite";
      throw SceneError(message.str());
    }
  } // namespace


  Newmark::Newmark(const double beta, const double gamma, const double dt)
    : beta(positive("beta", beta))
    , gamma(positive("gamma", gamma))
    , dt(positive("time step", dt))
    , alpha1(1. / (beta * dt * dt))
    , alpha2(1. / (beta * dt))
    , alpha3((1. - 2. * beta) / (2. * beta))
    , alpha4(gamma / (beta * dt))
    , alpha5(1. - gamma / beta)
    , alpha6((1. - gamma / (2. * beta)) * dt)
  {}

  Newmark::Newmark(const QuasiStatic, const double dt)
    : beta(0.)
    , gamma(0.)
    , dt(positive("time step", dt))
    , alpha1(0.)
    , alpha2(0.)
    , alpha3(0.)
    , alpha4(1. / dt)
    , alpha5(0.)
    , alpha6(0.)
  {}

  Newmark
  Newmark::quasi_static(const double dt)
  {
    return Newmark(QuasiStatic(), dt);
  }
} // namespace selkie
