#include <selkie/assembly/system.h>

#include <deal.II/base/mpi.h>

#include <boost/functional/hash.hpp>

#include <algorithm>
#include <numeric>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  System<dim>::System(const NodeCloud<dim>      &cloud,
                      const NodeConditions<dim> &conditions,
                      const unsigned int         pressure_phases)
    : cloud(cloud)
    , conditions(conditions)
    , pressure_phases(pressure_phases)
    , by_position(cloud.n_owned())
  {
    std::iota(by_position.begin(), by_position.end(), 0u);
    std::sort(by_position.begin(),
              by_position.end(),
              [&cloud](const unsigned int a, const unsigned int b) {
                if (cloud.layer(a) != cloud.layer(b))
                  return cloud.layer(a) < cloud.layer(b);
                for (int d = dim - 1; d >= 0; --d)
                  if (cloud.position(a)[d] != cloud.position(b)[d])
                    return cloud.position(a)[d] < cloud.position(b)[d];
                return false;
              });
  }

  template <int dim>
  void
  System<dim>::reinit(const Occupancy<dim>    &occupancy,
                      const SupportTable<dim> &table)
  {
    number_unknowns(occupancy, table);
    const std::size_t hash    = structure_hash(table);
    const MPI_Comm    comm    = cloud.partitioner()->get_mpi_communicator();
    const bool        changed = hash != last_hash || structures == 0;
    if (Utilities::MPI::max(changed ? 1 : 0, comm) == 1)
      {
        ++structures;
        tangent.reset();
        hat_tangent.reset();
        hats_wanted = false;
      }
    last_hash = hash;
  }

  template <int dim>
  void
  System<dim>::number_unknowns(const Occupancy<dim>    &occupancy,
                               const SupportTable<dim> &table)
  {
    const MPI_Comm comm = cloud.partitioner()->get_mpi_communicator();
    nodes.clear();
    pressures.clear();
    const auto phases_at = [&](const unsigned int node) {
      return occupancy.active[node] & pressure_phases;
    };
    for (const unsigned int node : by_position)
      if (occupancy.active[node] != 0)
        {
          nodes.push_back(node);
          for_each_bit(phases_at(node), [&](const unsigned int phase) {
            pressures.push_back({node, phase});
          });
        }
    n_u = dim * nodes.size();
    n_p = pressures.size();

    // First global numbers, on the owners; then on the halo.
    const types::global_dof_index n_mine = n_u + n_p;
    const IndexSet own = Utilities::MPI::create_ascending_partitioning(
      comm, n_mine)[Utilities::MPI::this_mpi_process(comm)];
    const types::global_dof_index first =
      n_mine > 0 ? own.nth_index_in_set(0) : 0;
    n_p_global = Utilities::MPI::sum(types::global_dof_index(n_p), comm);
    Vector u_first(cloud.partitioner()), p_first(cloud.partitioner());
    u_first = p_first = -1.;
    for (unsigned int k = 0; k < nodes.size(); ++k)
      u_first.local_element(nodes[k]) = first + dim * k;
    for (unsigned int k = n_p; k-- > 0;) // the first of a node stays
      p_first.local_element(pressures[k].node) = first + n_u + k;
    u_first.update_ghost_values();
    p_first.update_ghost_values();

    std::vector<bool> used(cloud.size(), false);
    for (const unsigned int node : table.nodes)
      used[node] = true;
    std::vector<types::global_dof_index> ghosts;
    for (unsigned int node = cloud.n_owned(); node < cloud.size(); ++node)
      if (used[node])
        {
          for (unsigned int d = 0; d < dim; ++d)
            ghosts.push_back(u_first.local_element(node) + d);
          const unsigned int n = std::bitset<32>(phases_at(node)).count();
          for (unsigned int k = 0; k < n; ++k)
            ghosts.push_back(p_first.local_element(node) + k);
        }
    std::sort(ghosts.begin(), ghosts.end());
    IndexSet wide(own.size());
    wide.add_indices(ghosts.begin(), ghosts.end());
    partition = std::make_shared<Utilities::MPI::Partitioner>(own, wide, comm);

    u_index.assign(cloud.size(), invalid_index);
    p_index.assign(pressure_phases != 0 ? cloud.size() : 0, invalid_index);
    p_phases.assign(p_index.size(), 0);
    is_held.assign(partition->locally_owned_size() +
                     partition->n_ghost_indices(),
                   false);
    for (unsigned int node = 0; node < cloud.size(); ++node)
      if (used[node] || (node < cloud.n_owned() && occupancy.active[node]))
        {
          u_index[node] = partition->global_to_local(
            static_cast<types::global_dof_index>(u_first.local_element(node)));
          if (p_first.local_element(node) < 0.)
            continue;
          p_index[node] = partition->global_to_local(
            static_cast<types::global_dof_index>(p_first.local_element(node)));
          p_phases[node] = phases_at(node);
        }
    update_held();
  }

  template <int dim>
  void
  System<dim>::update_held()
  {
    for (unsigned int node = 0; node < cloud.size(); ++node)
      if (u_index[node] != invalid_index)
        for (unsigned int d = 0; d < dim; ++d)
          is_held[u_index[node] + d] = (conditions.held(node) >> d) & 1u;
  }

  template <int dim>
  std::size_t
  System<dim>::structure_hash(const SupportTable<dim> &table) const
  {
    std::size_t hash = partition->size();
    for (const auto &patch : table.patches)
      if (patch.matter || patch.contact)
        {
          boost::hash_combine(hash, patch.n_nodes);
          boost::hash_combine(hash, patch.pressure ? patch.phase : 0u);
          for (unsigned int a = 0; a < patch.n_nodes; ++a)
            {
              const unsigned int node = table.nodes[patch.first_node + a];
              boost::hash_combine(hash,
                                  partition->local_to_global(u_index[node]));
            }
        }
    return hash;
  }

  template <int dim>
  std::shared_ptr<SystemMatrix>
  System<dim>::make_matrix(const std::vector<Coupling> &couplings) const
  {
    const auto global = [&](const unsigned int unknown) {
      return partition->local_to_global(unknown);
    };
    const auto append = [](const types::global_dof_index begin,
                           const unsigned int            n,
                           const bool                    pressures,
                           std::vector<ColumnRun>       &runs) {
      if (!runs.empty() && runs.back().end == begin &&
          runs.back().pressures == pressures)
        runs.back().end += n;
      else
        runs.push_back({begin, begin + n, pressures, 0});
    };

    // The columns of each coupling, and the couplings of each node.
    std::vector<std::vector<ColumnRun>> runs(couplings.size());
    std::vector<unsigned int>           begin(cloud.size() + 1, 0);
    for (unsigned int i = 0; i < couplings.size(); ++i)
      {
        const Coupling &coupling = couplings[i];
        for (auto node = coupling.begin; node != coupling.end; ++node)
          {
            ++begin[*node + 1];
            append(global(u_index[*node]), dim, false, runs[i]);
          }
        if (coupling.pressure)
          for (auto node = coupling.begin; node != coupling.end; ++node)
            append(global(pressure(*node, coupling.phase)), 1, true, runs[i]);
        join(runs[i]);
      }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<unsigned int> couplings_of(begin.back()), next = begin;
    for (unsigned int i = 0; i < couplings.size(); ++i)
      for (auto node = couplings[i].begin; node != couplings[i].end; ++node)
        couplings_of[next[*node]++] = i;

    std::vector<ColumnRun> columns, wider;
    const auto             columns_of = [&](const unsigned int node,
                                const ColumnRun   &diagonal,
                                const auto        &selects) {
      columns.assign(1, diagonal);
      for (unsigned int k = begin[node]; k < begin[node + 1]; ++k)
        if (selects(couplings[couplings_of[k]]))
          {
            unite(columns, runs[couplings_of[k]], wider);
            std::swap(columns, wider);
          }
      return columns;
    };
    std::vector<RowGroup> groups;
    for (unsigned int node = 0; node < cloud.size(); ++node)
      if (u_index[node] != invalid_index)
        {
          const auto u = global(u_index[node]);
          groups.push_back({u_index[node],
                            dim,
                            columns_of(node,
                                       {u, u + dim, false, 0},
                                       [](const Coupling &) { return true; })});
          if (p_index.empty())
            continue;
          for_each_bit(p_phases[node], [&](const unsigned int phase) {
            const unsigned int row = pressure(node, phase);
            const auto         p   = global(row);
            groups.push_back(
              {row,
               1,
               columns_of(node, {p, p + 1, true, 0}, [&](const Coupling &c) {
                 return c.pressure && c.phase == phase;
               })});
          });
        }
    std::sort(groups.begin(),
              groups.end(),
              [](const RowGroup &a, const RowGroup &b) {
                return a.first_row < b.first_row;
              });
    return std::make_shared<SystemMatrix>(partition, std::move(groups));
  }

  template <int dim>
  void
  System<dim>::want_matrix(const SupportTable<dim> &table)
  {
    point_tangent.reset();
    if (tangent)
      return;
    std::vector<Coupling> couplings;
    for (const auto &patch : table.patches)
      if (patch.matter || patch.contact)
        {
          const unsigned int *first = table.nodes.data() + patch.first_node;
          couplings.push_back(
            {first, first + patch.n_nodes, patch.pressure, patch.phase});
        }
    tangent = make_matrix(couplings);
  }

  template <int dim>
  void
  System<dim>::want_points()
  {
    tangent.reset();
    if (!point_tangent)
      point_tangent = std::make_unique<PointTangent<dim, double>>();
  }

  template <int dim>
  void
  System<dim>::want_hats(const bool wanted, const SupportTable<dim> &table)
  {
    hats_wanted = wanted;
    if (!wanted || hat_tangent)
      return;
    constexpr unsigned int    n_corners = 1u << dim;
    std::vector<unsigned int> corners;
    for (const auto &patch : table.patches)
      if (patch.matter)
        for (const unsigned int node :
             cloud.corners(patch.cell,
                           cloud.layer(table.nodes[patch.first_node])))
          corners.push_back(node);

    std::vector<Coupling> couplings;
    for (const auto &patch : table.patches)
      if (patch.matter)
        {
          const unsigned int *first =
            corners.data() + n_corners * couplings.size();
          couplings.push_back(
            {first, first + n_corners, patch.pressure, patch.phase});
        }
    for (const auto &patch : table.patches)
      if (patch.contact)
        {
          const unsigned int *first = table.nodes.data() + patch.first_node;
          couplings.push_back({first, first + patch.n_nodes, false, 0});
        }
    hat_tangent = make_matrix(couplings);
  }

  template <int dim>
  bool
  System<dim>::corner_pressures(const typename NodeCloud<dim>::Cell &cell,
                                const unsigned int                   phase,
                                CornerIndices &indices) const
  {
    const auto corners = cloud.corners(cell);
    for (unsigned int k = 0; k < corners.size(); ++k)
      {
        if (((p_phases[corners[k]] >> phase) & 1u) == 0)
          return false;
        indices[k] = pressure(corners[k], phase);
      }
    return true;
  }

  template class System<2>;
  template class System<3>;
} // namespace selkie
