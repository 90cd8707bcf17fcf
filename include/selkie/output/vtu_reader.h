#pragma once

#include <deal.II/base/point.h>

#include <string>
#include <utility>
#include <vector>

namespace selkie
{
  /// A field of a VTU file, point by point; vectors have 3 components and
  /// tensors 9 also in 2D.
  struct PointField
  {
    std::string         name, unit; ///< unit empty: none was written
    unsigned int        n_components = 1;
    std::vector<double> values;

    double
    operator()(const std::size_t point, const unsigned int component = 0) const
    {
      return values[point * n_components + component];
    }
  };

  /// Points and their fields. Single precision: VTU files hold no more.
  struct PointData
  {
    std::vector<dealii::Point<3>> positions; ///< m
    std::vector<PointField>       fields;

    /// Null if there is no field of that name.
    const PointField *
    find(const std::string &name) const;
  };

  /// The times (s) and files that a .pvd lists; paths include its folder.
  /// @throw SceneError if it cannot be read.
  std::vector<std::pair<double, std::string>>
  read_pvd(const std::string &path);

  /**
   * The points of all pieces of a .pvtu, as VtuWriter writes them: base64,
   * zlib in one block, or text where deal.II has no zlib.
   * @throw SceneError naming the file if it cannot be read, or has another
   * form.
   */
  PointData
  read_points(const std::string &pvtu);
} // namespace selkie
