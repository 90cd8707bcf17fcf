#include <selkie/terms/term.h>

namespace selkie
{
  TermUse &
  TermUse::operator|=(const TermUse &other)
  {
    kinematics |= other.kinematics;
    velocity_gradient |= other.velocity_gradient;
    velocity |= other.velocity;
    pressure |= other.pressure;
    acceleration |= other.acceleration;
    increment |= other.increment;
    stress |= other.stress;
    source |= other.source;
    mass |= other.mass;
    volume |= other.volume;
    mean |= other.mean;
    at_nodes |= other.at_nodes;
    energy |= other.energy;
    return *this;
  }
} // namespace selkie
