#include <selkie/assembly/system.h>

#include <deal.II/base/mpi.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/sparsity_tools.h>

#include <boost/functional/hash.hpp>

#include <algorithm>

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
  {}

  template <int dim>
  void
  System<dim>::reinit(const Occupancy<dim>    &occupancy,
                      const SupportTable<dim> &table)
  {
    number_unknowns(occupancy, table);
    const std::size_t hash    = structure_hash(table);
    const MPI_Comm    comm    = cloud.partitioner()->get_mpi_communicator();
    const bool        changed = hash != last_hash || sparsity_builds == 0;
    if (Utilities::MPI::max(changed ? 1 : 0, comm) == 1)
      build_sparsity(table);
    last_hash = hash;
  }

  template <int dim>
  void
  System<dim>::number_unknowns(const Occupancy<dim>    &occupancy,
                               const SupportTable<dim> &table)
  {
    const MPI_Comm comm = cloud.partitioner()->get_mpi_communicator();
    nodes.clear();
    p_nodes.clear();
    for (unsigned int node = 0; node < cloud.n_owned(); ++node)
      if (occupancy.active[node] != 0)
        {
          nodes.push_back(node);
          if ((occupancy.active[node] & pressure_phases) != 0)
            p_nodes.push_back(node);
        }
    n_u = dim * nodes.size();
    n_p = p_nodes.size();

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
    for (unsigned int k = 0; k < p_nodes.size(); ++k)
      p_first.local_element(p_nodes[k]) = first + n_u + k;
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
          if (p_first.local_element(node) >= 0.)
            ghosts.push_back(p_first.local_element(node));
        }
    std::sort(ghosts.begin(), ghosts.end());
    IndexSet wide(own.size());
    wide.add_indices(ghosts.begin(), ghosts.end());
    partition = std::make_shared<Utilities::MPI::Partitioner>(own, wide, comm);

    u_index.assign(cloud.size(), invalid_index);
    p_index.assign(pressure_phases != 0 ? cloud.size() : 0, invalid_index);
    is_held.assign(partition->locally_owned_size() +
                     partition->n_ghost_indices(),
                   false);
    for (unsigned int node = 0; node < cloud.size(); ++node)
      if (used[node] || (node < cloud.n_owned() && occupancy.active[node]))
        {
          u_index[node] = partition->global_to_local(
            static_cast<types::global_dof_index>(u_first.local_element(node)));
          if (p_first.local_element(node) >= 0.)
            p_index[node] =
              partition->global_to_local(static_cast<types::global_dof_index>(
                p_first.local_element(node)));
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
      if (patch.matter)
        {
          boost::hash_combine(hash, patch.n_nodes);
          for (unsigned int a = 0; a < patch.n_nodes; ++a)
            {
              const unsigned int node = table.nodes[patch.first_node + a];
              boost::hash_combine(hash,
                                  partition->local_to_global(u_index[node]));
            }
        }
    return hash;
  }

  /// A matrix in which the nodes of each list couple with each other: all
  /// displacements, and the pressures of the lists that have one.
  template <int dim>
  typename System<dim>::Matrix
  System<dim>::make_matrix(const std::vector<Coupling> &couplings) const
  {
    // Node by node: a row of a node couples with all lists that it is in.
    std::vector<std::vector<const Coupling *>> lists_of(cloud.size());
    for (const auto &coupling : couplings)
      for (const unsigned int node : coupling.nodes)
        lists_of[node].push_back(&coupling);

    std::vector<unsigned int> seen(cloud.size(), 0);
    unsigned int              visit      = 0;
    const auto                neighbours = [&](const unsigned int         node,
                                const bool                 with_pressure,
                                std::vector<unsigned int> &list) {
      list.clear();
      ++visit;
      for (const Coupling *coupling : lists_of[node])
        if (!with_pressure || coupling->pressure)
          for (const unsigned int other : coupling->nodes)
            {
              if (seen[other] != visit)
                list.push_back(other);
              seen[other] = visit;
            }
    };

    IndexSet relevant = partition->locally_owned_range();
    relevant.add_indices(partition->ghost_indices());
    DynamicSparsityPattern pattern(n_global(), n_global(), relevant);
    std::vector<types::global_dof_index> entries;
    std::vector<unsigned int>            all_nodes, pressure_nodes;
    for (unsigned int node = 0; node < cloud.size(); ++node)
      if (u_index[node] != invalid_index)
        {
          const auto global = [&](const unsigned int index) {
            return partition->local_to_global(index);
          };
          const auto set_columns =
            [&](const std::vector<unsigned int> &u_list) {
              entries.clear();
              for (const unsigned int b : u_list)
                for (unsigned int d = 0; d < dim; ++d)
                  entries.push_back(global(u_index[b]) + d);
              if (pressure_phases != 0)
                for (const unsigned int b : pressure_nodes)
                  entries.push_back(global(p_index[b]));
              std::sort(entries.begin(), entries.end());
            };
          neighbours(node, false, all_nodes);
          if (pressure_phases != 0)
            neighbours(node, true, pressure_nodes);
          set_columns(all_nodes);
          for (unsigned int d = 0; d < dim; ++d)
            {
              const auto row = global(u_index[node]) + d;
              pattern.add_entries(row, entries.begin(), entries.end(), true);
              pattern.add(row, row);
            }
          if (pressure(node) != invalid_index)
            {
              const auto row = global(p_index[node]);
              set_columns(pressure_nodes);
              pattern.add_entries(row, entries.begin(), entries.end(), true);
              pattern.add(row, row);
            }
        }
    const MPI_Comm comm = partition->get_mpi_communicator();
    const auto    &own  = partition->locally_owned_range();
    if (Utilities::MPI::n_mpi_processes(comm) > 1)
      SparsityTools::distribute_sparsity_pattern(pattern, own, comm, relevant);
    Matrix result;
    result.values = std::make_shared<TrilinosWrappers::SparseMatrix>();
    result.values->reinit(own, own, pattern, comm, true);

    result.columns.resize(is_held.size());
    for (unsigned int i = 0; i < result.columns.size(); ++i)
      result.columns[i] = result.values->trilinos_matrix().ColMap().LID(
        static_cast<int>(partition->local_to_global(i)));
    return result;
  }

  template <int dim>
  void
  System<dim>::build_sparsity(const SupportTable<dim> &table)
  {
    std::vector<Coupling> couplings;
    for (const auto &patch : table.patches)
      if (patch.matter)
        {
          const auto first = table.nodes.begin() + patch.first_node;
          couplings.push_back({{first, first + patch.n_nodes},
                               bool((pressure_phases >> patch.phase) & 1u)});
        }
    auto matrix = make_matrix(couplings);
    tangent     = std::move(matrix.values);
    columns     = std::move(matrix.columns);
    ++sparsity_builds;
    hat_tangent.reset();
    if (hats_wanted)
      build_hats(table);
  }

  template <int dim>
  void
  System<dim>::build_hats(const SupportTable<dim> &table)
  {
    std::vector<Coupling> couplings;
    for (const auto &patch : table.patches)
      if (patch.matter)
        {
          const auto corners = cloud.corners(patch.cell);
          couplings.push_back({{corners.begin(), corners.end()},
                               bool((pressure_phases >> patch.phase) & 1u)});
        }
    auto matrix = make_matrix(couplings);
    hat_tangent = std::move(matrix.values);
    hat_columns = std::move(matrix.columns);
  }

  template <int dim>
  void
  System<dim>::want_hats(const SupportTable<dim> &table)
  {
    hats_wanted = true;
    if (!hat_tangent)
      build_hats(table);
  }

  template <int dim>
  bool
  System<dim>::corner_pressures(const typename NodeCloud<dim>::Cell &cell,
                                CornerIndices &indices) const
  {
    const auto corners = cloud.corners(cell);
    for (unsigned int k = 0; k < corners.size(); ++k)
      {
        indices[k] = pressure(corners[k]);
        if (indices[k] == invalid_index)
          return false;
      }
    return true;
  }

  template class System<2>;
  template class System<3>;
} // namespace selkie
