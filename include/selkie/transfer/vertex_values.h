#pragma once

#include <selkie/mesh/cell_locator.h>

#include <boost/functional/hash.hpp>

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace selkie
{
  template <int dim>
  struct CarriedFields;

  /**
   * The values of fields at the vertices of a mesh that is about to change, and
   * where its flags will make new vertices: there the mean of the nodes around,
   * NaN if one of them has no value. Vertices are told by where they are, so
   * the mesh may be shared out among the ranks in any other way afterwards.
   */
  template <int dim>
  class VertexValues
  {
  public:
    /// @param fields on the mesh as it is, with flags that keep the balance
    explicit VertexValues(const CarriedFields<dim> &fields);

    /// Gives the fields, numbered anew on the changed mesh, their values.
    /// Once. Throws if some vertex was neither there nor made by the flags.
    /// Collective.
    void
    fill(CarriedFields<dim> &fields);

  private:
    using Key     = std::array<std::int64_t, dim>;
    using Locator = CellLocator<dim>;

    struct Entry
    {
      bool                exact; ///< a node's, not a mean
      std::vector<double> values;
    };
    using Entries = std::unordered_map<Key, Entry, boost::hash<Key>>;

    static void
    add(Entries &entries, const Key &key, const Entry &entry);

    /// Those whose vertex's upper side is a cell of this rank. Collective.
    Entries
    share_out(const dealii::parallel::distributed::Triangulation<dim> &mesh);

    const std::size_t n_values; ///< of a vertex: fields times layers
    Entries           entries;
  };
} // namespace selkie
