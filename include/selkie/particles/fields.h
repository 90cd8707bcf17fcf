#pragma once

#include <deal.II/base/array_view.h>
#include <deal.II/base/exceptions.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
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
    operator()(const dealii::ArrayView<const double> &properties) const
    {
      Assert(exists(), dealii::ExcMessage("This column was not registered."));
      if constexpr (std::is_same<T, double>::value)
        return properties[offset];
      else
        {
          T value;
          std::copy_n(properties.data() + offset,
                      n_components,
                      value.begin_raw());
          return value;
        }
    }

    void
    set(const dealii::ArrayView<double> &properties, const T &value) const
    {
      Assert(exists(), dealii::ExcMessage("This column was not registered."));
      if constexpr (std::is_same<T, double>::value)
        properties[offset] = value;
      else
        std::copy_n(value.begin_raw(),
                    n_components,
                    properties.data() + offset);
    }

    static constexpr unsigned int n_components = sizeof(T) / sizeof(double);

    static constexpr unsigned int absent = static_cast<unsigned int>(-1);
    unsigned int                  offset = absent;
  };

  /// What becomes of a property when points become one; when one becomes
  /// several, a sum is shared out and all else is theirs as well.
  enum class Combine
  {
    mean, ///< weighted with the reference volume
    sum,
    label ///< all of them have the same
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
      Combine      combine;
    };

    /// Registers a column, or returns the one of that name that is there
    /// (which is then written when either asked for it).
    template <typename T>
    Column<T>
    add(const std::string &name,
        const std::string &unit,
        const bool         output  = false,
        const Combine      combine = Combine::mean)
    {
      return Column<T>(
        place(name, unit, Column<T>::n_components, output, combine).offset);
    }

    /// The column of that name; one that does not exist if nobody asked for it.
    template <typename T>
    Column<T>
    find(const std::string &name) const
    {
      for (const Entry &entry : list)
        if (entry.name == name)
          return Column<T>(entry.offset);
      return Column<T>();
    }

    unsigned int
    n_components() const
    {
      return list.empty() ? 0 : list.back().offset + list.back().n_components;
    }

    const std::vector<Entry> &
    entries() const
    {
      return list;
    }

  private:
    const Entry &
    place(const std::string &name,
          const std::string &unit,
          const unsigned int n,
          const bool         output,
          const Combine      combine)
    {
      for (Entry &entry : list)
        if (entry.name == name)
          {
            AssertThrow(entry.n_components == n && entry.unit == unit,
                        dealii::ExcMessage("The particle column '" + name +
                                           "' is registered twice, with "
                                           "different sizes or units."));
            entry.output |= output;
            return entry;
          }
      list.push_back({name, unit, n_components(), n, output, combine});
      return list.back();
    }

    std::vector<Entry> list;
  };
} // namespace selkie
