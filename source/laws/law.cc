#include <selkie/base/exceptions.h>
#include <selkie/laws/law.h>

#include <cmath>
#include <sstream>

namespace selkie
{
  void
  check_parameter(const bool         valid,
                  const std::string &parameter,
                  const double       value,
                  const std::string &allowed)
  {
    if (valid)
      return;
    std::ostringstream message;
    message << "the parameter '" << parameter << "' is " << value
            << "; it must be " << allowed;
    throw SceneError(message.str());
  }

  void
  check_positive(const std::string &parameter, const double value)
  {
    check_parameter(value > 0. && std::isfinite(value),
                    parameter,
                    value,
                    "positive and finite");
  }
} // namespace selkie
