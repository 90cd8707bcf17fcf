#pragma once

#include <deal.II/base/array_view.h>
#include <deal.II/base/tensor.h>

#include <string>
#include <type_traits>
#include <vector>

namespace selkie
{
  /// A typed place in the property array of a material point. T is double or
  /// a dealii::Tensor.
  template <typename T>
  class Column
  {
  public:
    Column() = default;
    explicit Column(const unsigned int offset)
      : offset(offset)
    {}

    /// Whether some active law or term asked for this column.
    bool
    exists() const
    {
      return offset != absent;
    }

    T
    operator()(const dealii::ArrayView<const double> &properties) const;

    void
    set(const dealii::ArrayView<double> &properties, const T &value) const;

    static constexpr unsigned int n_components =
      sizeof(T) / sizeof(double);

    static constexpr unsigned int absent = static_cast<unsigned int>(-1);
    unsigned int                  offset = absent;
  };

  /**
   * What a material point carries, as registered by the active laws and
   * terms. Migration, checkpoint and VTU output follow from this list, so no
   * field is listed twice.
   */
  class ParticleFields
  {
  public:
    struct Entry
    {
      std::string  name;
      std::string  unit;
      unsigned int offset;
      unsigned int n_components;
      bool         output; ///< written to particles.pvd
    };

    /// Registers a column, or returns the one of that name that is there.
    template <typename T>
    Column<T>
    add(const std::string &name,
        const std::string &unit,
        const bool         output = false);

    unsigned int
    n_components() const;

    const std::vector<Entry> &
    entries() const;

  private:
    std::vector<Entry> list;
  };
} // namespace selkie
