#pragma once

#include <selkie/study/study.h>

#include <string>
#include <vector>

namespace selkie
{
  /// A curve over time, as a run's CSV files hold it.
  struct Curve
  {
    std::vector<double> times, values;
  };

  /// The quantity's curve in the output folder of a run.
  /// @throw SceneError if the file or the column is not there.
  Curve
  read_curve(const StudyQuantity &quantity, const std::string &folder);

  /// One number for a curve. NaN for an empty one.
  double
  reduce(const Curve &curve, const Reduction reduction);

  /**
   * The error of a curve against the quantity's reference: relative, except
   * without a reference, where it is the number over the quantity's scale. Of a
   * reference that is a curve (function, file, run), `rms` takes the norm of
   * the difference over that of the reference, every other reduction the
   * difference of the numbers.
   * @param reference_folder of the reference run, if there is one
   */
  double
  error_of(const Curve         &curve,
           const StudyQuantity &quantity,
           const std::string   &reference_folder);
} // namespace selkie
