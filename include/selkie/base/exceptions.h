#pragma once

#include <deal.II/base/point.h>

#include <sstream>
#include <stdexcept>
#include <string>

/**
 * @file
 * The ways in which a run ends early. A SceneError or an OutputError is the
 * user's to mend (exit code 1); a NumericalFailure is first answered by a
 * smaller time step and, when no retry is left, ends the run with a checkpoint
 * (exit code 2). Programmer errors are dealii's Assert.
 */
namespace selkie
{
  /// Bad input or usage. The message names file, parameter, value and what is
  /// allowed. Exit code 1.
  class SceneError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /// A result that cannot be written: the disk is full, the folder is gone.
  /// Thrown on all ranks. Exit code 1.
  class OutputError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /// A step that cannot be completed as asked. Exit code 2 after all retries.
  class NumericalFailure : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /// One that shorter steps do not prevent: the step is not tried again.
  class CertainFailure : public NumericalFailure
  {
  public:
    using NumericalFailure::NumericalFailure;
  };

  /// A point for which the local maximum-entropy problem has no solution: it
  /// lies outside the convex hull of its nodes, or too few nodes are near.
  template <int dim>
  class OutsideHull : public NumericalFailure
  {
  public:
    OutsideHull(const dealii::Point<dim> &point, const std::string &why)
      : NumericalFailure(text(point, why))
      , point(point)
    {}

    const dealii::Point<dim> point;

  private:
    static std::string
    text(const dealii::Point<dim> &point, const std::string &why)
    {
      std::ostringstream out;
      out << "no LME shape functions at the point (" << point << "): " << why;
      return out.str();
    }
  };

  /// det F <= 0 at an integration point.
  class InvertedPoint : public NumericalFailure
  {
  public:
    using NumericalFailure::NumericalFailure;
  };

  /// Newton's iteration did not reach its tolerance.
  class NewtonFailure : public NumericalFailure
  {
  public:
    using NumericalFailure::NumericalFailure;
  };

  /// The linear solver and its fallback broke down.
  class LinearSolverFailure : public NumericalFailure
  {
  public:
    using NumericalFailure::NumericalFailure;
  };
} // namespace selkie
