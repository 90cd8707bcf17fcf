#include <selkie/base/types.h>
#include <selkie/transfer/carried_fields.h>
#include <selkie/transfer/vertex_values.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    using Mesh = parallel::distributed::Triangulation<dim>;

    template <int dim>
    const Mesh<dim> &
    mesh_of(const CarriedFields<dim> &fields)
    {
      return dynamic_cast<const Mesh<dim> &>(fields.dofs.get_triangulation());
    }

    /// Parts of the domain's extent by which vertices are told: far more than
    /// cells, few enough for doubles.
    constexpr double n_parts = 1ull << 40;

    template <int dim>
    std::array<std::int64_t, dim>
    key_of(const CellLocator<dim> &locator, const Point<dim> &x)
    {
      std::array<std::int64_t, dim> key;
      for (unsigned int d = 0; d < dim; ++d)
        key[d] =
          std::llround((x[d] - locator.lower()[d]) /
                       (locator.upper()[d] - locator.lower()[d]) * n_parts);
      return key;
    }

    /// A place in the cell on the upper side of a vertex, inside the domain;
    /// the same on all ranks.
    template <int dim, typename Key>
    Point<dim>
    upper_side(const CellLocator<dim> &locator,
               const Key              &key,
               const double            inset)
    {
      Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = std::min(locator.lower()[d] +
                          key[d] / n_parts *
                            (locator.upper()[d] - locator.lower()[d]) +
                          inset,
                        locator.upper()[d] - inset);
      return x;
    }

    /// Of the lattice of a cell's corners, its middles of edges and faces and
    /// its centre: the corners around each place.
    template <int dim>
    std::vector<std::vector<unsigned int>>
    corners_around(const bool is_halved)
    {
      std::vector<std::vector<unsigned int>> places;
      for (unsigned int v = 0; v < (1u << dim); ++v)
        places.push_back({v});
      if (!is_halved)
        return places;
      for (unsigned int i = 0; i < (dim == 2 ? 9 : 27); ++i)
        {
          std::vector<unsigned int> around = {0};
          for (unsigned int d = 0, rest = i; d < dim; rest /= 3, ++d)
            {
              const auto n = around.size();
              for (unsigned int k = 0; k < n; ++k)
                {
                  const unsigned int lower = around[k];
                  if (rest % 3 > 0)
                    around[k] |= 1u << d;
                  if (rest % 3 == 1)
                    around.push_back(lower);
                }
            }
          if (around.size() > 1)
            places.push_back(around);
        }
      return places;
    }
  } // namespace


  template <int dim>
  VertexValues<dim>::VertexValues(const CarriedFields<dim> &fields)
    : n_values(fields.values.size() * fields.n_layers)
  {
    const Locator                        locator(mesh_of(fields));
    const auto                           as_is  = corners_around<dim>(false);
    const auto                           halved = corners_around<dim>(true);
    std::vector<types::global_dof_index> indices(
      fields.dofs.get_fe().n_dofs_per_cell());
    for (const auto &cell : fields.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(indices);
          for (const auto &corners : cell->refine_flag_set() ? halved : as_is)
            {
              const double n = corners.size();
              Point<dim>   x;
              Entry        entry{corners.size() == 1, {}};
              for (const unsigned int v : corners)
                x += cell->vertex(v) / n;
              for (const auto &[name, field] : fields.values)
                for (unsigned int layer = 0; layer < fields.n_layers; ++layer)
                  {
                    double sum = 0.;
                    for (const unsigned int v : corners)
                      sum += field(indices[v * fields.n_layers + layer]);
                    entry.values.push_back(sum / n);
                  }
              add(entries, key_of(locator, x), entry);
            }
        }
  }


  template <int dim>
  void
  VertexValues<dim>::add(Entries &entries, const Key &key, const Entry &entry)
  {
    const auto [place, is_new] = entries.try_emplace(key, entry);
    if (!is_new && entry.exact && !place->second.exact)
      place->second = entry;
  }


  template <int dim>
  typename VertexValues<dim>::Entries
  VertexValues<dim>::share_out(const Mesh<dim> &mesh)
  {
    const MPI_Comm comm = mesh.get_communicator();
    if (Utilities::MPI::n_mpi_processes(comm) == 1)
      return std::move(entries);
    const Locator           locator(mesh);
    std::vector<Point<dim>> places;
    for (const auto &[key, entry] : entries)
      places.push_back(
        upper_side(locator, key, 0.25 * locator.smallest_spacing()));
    const auto owners =
      const_cast<Mesh<dim> &>(mesh).find_point_owner_rank(places);

    // Key, whether exact, and values, one after the other.
    std::map<unsigned int, std::vector<double>> parcels;
    auto                                        owner = owners.begin();
    for (const auto &[key, entry] : entries)
      {
        auto &parcel = parcels[*owner++];
        parcel.insert(parcel.end(), key.begin(), key.end());
        parcel.push_back(entry.exact);
        parcel.insert(parcel.end(), entry.values.begin(), entry.values.end());
      }
    Entries mine;
    for (const auto &[rank, parcel] :
         Utilities::MPI::some_to_some(comm, parcels))
      for (auto number = parcel.begin(); number != parcel.end();)
        {
          Key key;
          for (auto &k : key)
            k = static_cast<std::int64_t>(*number++);
          const bool exact = *number++ != 0.;
          add(mine, key, {exact, {number, number + n_values}});
          number += n_values;
        }
    return mine;
  }


  template <int dim>
  void
  VertexValues<dim>::fill(CarriedFields<dim> &fields)
  {
    const Mesh<dim> &mesh = mesh_of(fields);
    const Locator    locator(mesh);
    const Entries    mine = share_out(mesh);
    // One rank knows each vertex's values, be it its owner or not.
    Vector known(fields.values.begin()->second.get_partitioner());
    for (auto &[name, field] : fields.values)
      field = 0.;
    std::vector<types::global_dof_index> indices(
      fields.dofs.get_fe().n_dofs_per_cell());
    for (const auto &cell : fields.dofs.active_cell_iterators())
      if (!cell->is_artificial())
        {
          cell->get_dof_indices(indices);
          for (const unsigned int v : cell->vertex_indices())
            if (const auto found = mine.find(key_of(locator, cell->vertex(v)));
                found != mine.end())
              {
                auto value = found->second.values.begin();
                for (auto &[name, field] : fields.values)
                  for (unsigned int layer = 0; layer < fields.n_layers; ++layer)
                    {
                      const auto dof = indices[v * fields.n_layers + layer];
                      field(dof)     = *value++;
                      known(dof)     = 1.;
                    }
              }
        }
    known.compress(VectorOperation::add);
    AssertThrow(std::all_of(known.begin(),
                            known.end(),
                            [](const double n) { return n == 1.; }),
                ExcInternalError());
    for (auto &[name, field] : fields.values)
      field.compress(VectorOperation::add);
  }


  template class VertexValues<2>;
  template class VertexValues<3>;
} // namespace selkie
