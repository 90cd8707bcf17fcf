#pragma once

#include <string>

namespace selkie
{
  /// What a body is made of, as far as the choice of terms is concerned.
  enum class Phase
  {
    solid,
    fluid
  };

  /// A constitutive law: from kinematics to stress, energy and tangent. It
  /// knows no mesh, no degree of freedom and no particle, and is immutable.
  class Law
  {
  public:
    virtual ~Law() = default;

    /// Solid or fluid.
    virtual Phase
    phase() const = 0;

    /// Mass per reference volume, kg/m^3.
    virtual double
    density() const = 0;

    /// Speed of pressure (P) waves in the undeformed state, m/s.
    virtual double
    sound_speed() const = 0;
  };

  /// The check of one material parameter.
  /// @throw SceneError naming @p parameter, @p value and what is @p allowed,
  /// unless @p valid.
  void
  check_parameter(const bool         valid,
                  const std::string &parameter,
                  const double       value,
                  const std::string &allowed);

  /// @throw SceneError unless @p value is positive and finite.
  void
  check_positive(const std::string &parameter, const double value);
} // namespace selkie
