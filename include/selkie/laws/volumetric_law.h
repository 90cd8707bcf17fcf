#pragma once

namespace selkie
{
  /// A law whose pressure follows from the volume ratio alone: what the mixed
  /// form needs, in which the pressure is an unknown of its own and does not
  /// lock. Fluids are such, and solids with decoupled shape and volume changes.
  class VolumetricLaw
  {
  public:
    virtual ~VolumetricLaw() = default;

    /// Pressure p(J), Pa, positive in compression.
    /// @throw InvertedPoint if J <= 0.
    virtual double
    pressure(const double J) const = 0;

    /// dp/dJ, Pa; negative.
    /// @throw InvertedPoint if J <= 0.
    virtual double
    dpressure_dJ(const double J) const = 0;

    /// The volume ratio at which the pressure is @p p (Pa).
    /// @throw NumericalFailure if the law never reaches that tension.
    virtual double
    J_of_pressure(const double p) const = 0;

    /// dJ/dp at the pressure @p p (Pa), 1/Pa; negative.
    /// @throw NumericalFailure as J_of_pressure().
    virtual double
    dJ_dpressure(const double p) const = 0;

    /// Bulk modulus -J dp/dJ at J = 1, Pa.
    virtual double
    bulk_modulus() const = 0;

    /// What resists a change of shape in a step, Pa: the shear modulus, or the
    /// viscosity times @p alpha4 (1/s), Newmark's dv/du.
    virtual double
    shear_stiffness(const double alpha4) const = 0;
  };
} // namespace selkie
