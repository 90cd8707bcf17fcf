#pragma once

#include <selkie/output/difference.h>
#include <selkie/output/run_folder.h>
#include <selkie/output/vtu_reader.h>

#include <string>
#include <utility>
#include <vector>

namespace selkie
{
  /// Numbers of a time in a list A and of the one in a list B that is nearest
  /// to it.
  using TimePairs = std::vector<std::pair<std::size_t, std::size_t>>;

  /// The times of A for which B has one within half of the smaller interval
  /// (the median of the steps of each list; of one time alone none).
  TimePairs
  pair_times(const std::vector<double> &a, const std::vector<double> &b);

  /// The points of a body, in a picture of several.
  struct BodyPoints
  {
    const PointData         *data = nullptr;
    std::vector<std::size_t> points; ///< those of the body
  };

  /// Where a field of A differs from B's.
  struct FieldSums
  {
    std::string    quantity; ///< with its unit
    DifferenceSums sums;
    bool           varies = false; ///< A or B, from point to point or from 0
  };

  /**
   * Displacement, velocity, pressure, deformation gradient, volume ratio and
   * Cauchy stress at A's points, as far as A and B have them. B's values there
   * are those of the linear function that fits its points nearby
   * (PointSampler), by reference position, or by position if one of the two
   * does not have it. Weighted with A's reference volume.
   * @param time of A (s)
   */
  template <int dim>
  std::vector<FieldSums>
  compare_body(const BodyPoints &a, const BodyPoints &b, const double time);

  /// The differences of all fields of the bodies that both runs have, for all
  /// times that both have and, without time, over all of these (all with the
  /// same weight). Quantities that a body does not have, such as a solid's
  /// pressure, are 0 or 1 in both runs always; they are left out.
  /// @throw SceneError if a file cannot be read.
  template <int dim>
  std::vector<Difference>
  compare_fields(const RunFolder &a, const RunFolder &b);
} // namespace selkie
