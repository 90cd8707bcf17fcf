#include <selkie/assembly/row_products.h>
#include <selkie/assembly/system_matrix.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/types.h>

#include <boost/serialization/vector.hpp>

#include <Epetra_CrsGraph.h>
#include <Epetra_Map.h>
#include <Epetra_MpiComm.h>

#include <algorithm>
#include <map>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    constexpr auto begins_before = [](const ColumnRun &a, const ColumnRun &b) {
      return a.begin < b.begin;
    };

    /// Lets a run go into one that begins before it, if it can.
    bool
    is_joined(ColumnRun &before, const ColumnRun &run)
    {
      if (run.begin > before.end || run.pressures != before.pressures)
        return false;
      before.end = std::max(before.end, run.end);
      return true;
    }
  } // namespace


  void
  join(std::vector<ColumnRun> &runs)
  {
    std::sort(runs.begin(), runs.end(), begins_before);
    std::size_t n = 0; // joined so far
    for (const ColumnRun &run : runs)
      if (n == 0 || !is_joined(runs[n - 1], run))
        runs[n++] = run;
    runs.resize(n);
  }


  void
  unite(const std::vector<ColumnRun> &a,
        const std::vector<ColumnRun> &b,
        std::vector<ColumnRun>       &both)
  {
    both.clear();
    auto in_a = a.begin(), in_b = b.begin();
    while (in_a != a.end() || in_b != b.end())
      {
        const bool from_a =
          in_b == b.end() || (in_a != a.end() && in_a->begin <= in_b->begin);
        const ColumnRun &run = from_a ? *in_a++ : *in_b++;
        if (both.empty() || !is_joined(both.back(), run))
          both.push_back(run);
      }
  }


  namespace
  {
    /// Row groups in global numbers, for another rank.
    class Message
    {
    public:
      void
      put(const types::global_dof_index first_row, const RowGroup &group)
      {
        add(first_row);
        add(group.n_rows);
        add(group.columns.size());
        for (const ColumnRun &run : group.columns)
          {
            add(run.begin);
            add(run.end);
            add(run.pressures);
          }
      }

      /// @param rows for local numbers of the rows
      std::vector<RowGroup>
      read(const SystemMatrix::Partitioner &rows) const
      {
        std::vector<RowGroup> groups;
        for (auto next = numbers.begin(); next != numbers.end();)
          {
            RowGroup &group = groups.emplace_back();
            group.first_row = rows.global_to_local(*next++);
            group.n_rows    = *next++;
            group.columns.resize(*next++);
            for (ColumnRun &run : group.columns)
              {
                run.begin     = *next++;
                run.end       = *next++;
                run.pressures = *next++ != 0;
              }
          }
        return groups;
      }

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &numbers;
      }

    private:
      void
      add(const std::size_t number)
      {
        numbers.push_back(number);
      }

      std::vector<types::global_dof_index> numbers;
    };

    /// Where runs stand in a row, in their present order.
    void
    set_positions(std::vector<ColumnRun> &runs)
    {
      unsigned int position = 0;
      for (ColumnRun &run : runs)
        {
          run.position = position;
          position += run.length();
        }
    }

    /// From global numbers to those of the columns, ascending; each entry keeps
    /// its position. A run that leaves what the rank owns falls into parts.
    void
    localise(std::vector<ColumnRun>          &runs,
             const SystemMatrix::Partitioner &columns)
    {
      constexpr auto last             = numbers::invalid_dof_index;
      const auto [own_begin, own_end] = columns.local_range();
      std::vector<ColumnRun> local;
      for (const ColumnRun &run : runs)
        {
          types::global_dof_index begin = run.begin;
          for (const auto limit : {own_begin, own_end, last})
            {
              const auto end = std::min(run.end, limit);
              if (begin >= end)
                continue;
              ColumnRun part = run;
              part.begin     = columns.global_to_local(begin);
              part.end       = part.begin + (end - begin);
              part.position += begin - run.begin;
              local.push_back(part);
              begin = end;
            }
        }
      std::sort(local.begin(), local.end(), begins_before);
      runs = std::move(local);
    }
  } // namespace


  SystemMatrix::SystemMatrix(const std::shared_ptr<const Partitioner> &rows,
                             std::vector<RowGroup>                   &&all)
    : rows(rows)
    , n_owned(rows->locally_owned_size())
    , groups(std::move(all))
    , group_of_row(n_owned + rows->n_ghost_indices(), invalid_index)
  {
    for (RowGroup &group : groups)
      {
        join(group.columns);
        set_positions(group.columns);
        n_owned_groups += group.first_row < n_owned;
        for (unsigned int r = 0; r < group.n_rows; ++r)
          group_of_row[group.first_row + r] = &group - groups.data();
      }
    place_ghost_values();
    exchange_columns();
    number_columns();
    make_epetra_matrix();
  }


  void
  SystemMatrix::place_ghost_values()
  {
    std::size_t next = 0;
    for (unsigned int i = 0; i < rows->n_ghost_indices(); ++i)
      {
        ghost_start.push_back(next);
        next += group(n_owned + i).row_length();
      }
    ghost_start.push_back(next);
    ghost_values.resize(next);
    unsigned int ghost = 0;
    for (const auto &[rank, n_rows] : rows->ghost_targets())
      {
        const std::size_t begin = ghost_start[ghost];
        ghost += n_rows;
        outgoing.push_back({rank, begin, ghost_start[ghost] - begin});
      }
  }


  /// Owners of ghost rows learn their columns, and get what they lack of them.
  void
  SystemMatrix::exchange_columns()
  {
    std::map<unsigned int, Message> messages;
    unsigned int                    row = n_owned;
    for (const auto &[rank, n_rows] : rows->ghost_targets())
      for (const unsigned int end = row + n_rows; row < end;
           row += group(row).n_rows)
        messages[rank].put(rows->local_to_global(row), group(row));
    for (auto &[rank, message] :
         Utilities::MPI::some_to_some(rows->get_mpi_communicator(), messages))
      {
        incoming.push_back({rank, message.read(*rows), {}});
        for (const RowGroup &theirs : incoming.back().groups)
          {
            auto &ours = groups[group_of_row[theirs.first_row]].columns;
            ours.insert(ours.end(),
                        theirs.columns.begin(),
                        theirs.columns.end());
          }
      }
    for (Incoming &message : incoming)
      for (RowGroup &theirs : message.groups)
        {
          join(groups[group_of_row[theirs.first_row]].columns);
          set_positions(theirs.columns);
        }
  }


  void
  SystemMatrix::number_columns()
  {
    const IndexSet &own     = rows->locally_owned_range();
    const auto [begin, end] = rows->local_range();
    std::vector<ColumnRun> others;
    for (const RowGroup &group : groups)
      for (const ColumnRun &run : group.columns)
        if (run.begin < begin || run.end > end)
          others.push_back({run.begin, run.end, false, 0});
    join(others);
    IndexSet ghosts(own.size());
    for (const ColumnRun &run : others)
      ghosts.add_range(run.begin, run.end);
    ghosts.add_indices(rows->ghost_indices());
    ghosts.subtract_set(own);
    column_partition =
      std::make_shared<Partitioner>(own, ghosts, rows->get_mpi_communicator());

    for (RowGroup &group : groups)
      {
        localise(group.columns, *column_partition);
        if (group.first_row < n_owned)
          set_positions(group.columns); // Epetra's
      }
    for (Incoming &message : incoming)
      {
        std::size_t n_values = 0;
        for (RowGroup &group : message.groups)
          {
            localise(group.columns, *column_partition);
            n_values += group.n_rows * group.row_length();
          }
        message.buffer.resize(n_values);
      }
    for (unsigned int i = 0; i < rows->n_ghost_indices(); ++i)
      ghost_columns.push_back(
        column_partition->global_to_local(rows->local_to_global(n_owned + i)));
    wide.reinit(column_partition);
  }


  void
  SystemMatrix::make_epetra_matrix()
  {
    const Epetra_MpiComm comm(rows->get_mpi_communicator());
    std::vector<int>     numbers;
    for (unsigned int i = 0; i < n_owned + column_partition->n_ghost_indices();
         ++i)
      numbers.push_back(column_partition->local_to_global(i));
    const int        n_rows = rows->size();
    const Epetra_Map row_map(n_rows, n_owned, numbers.data(), 0, comm);
    const Epetra_Map column_map(-1, numbers.size(), numbers.data(), 0, comm);

    std::vector<int> row_lengths;
    for_each_owned_group([&](const RowGroup &group) {
      row_lengths.insert(row_lengths.end(), group.n_rows, group.row_length());
    });
    Epetra_CrsGraph  graph(Copy, row_map, column_map, row_lengths.data(), true);
    std::vector<int> entries;
    for_each_owned_group([&](const RowGroup &group) {
      entries.clear();
      for (const ColumnRun &run : group.columns)
        for (unsigned int k = run.begin; k < run.end; ++k)
          entries.push_back(k);
      for (unsigned int r = 0; r < group.n_rows; ++r)
        graph.InsertMyIndices(group.first_row + r,
                              entries.size(),
                              entries.data());
    });
    graph.FillComplete(row_map, row_map);
    graph.OptimizeStorage();
    matrix = std::make_unique<Epetra_CrsMatrix>(Copy, graph);
    int *unused;
    matrix->ExtractCrsDataPointers(row_start, unused, values);
  }


  void
  SystemMatrix::clear()
  {
    matrix->PutScalar(0.);
    std::fill(ghost_values.begin(), ghost_values.end(), 0.);
  }


  void
  SystemMatrix::add(const unsigned int row,
                    const unsigned int unknown,
                    const double       value)
  {
    const unsigned int k   = column(unknown);
    const auto        &all = group(row).columns;
    const auto         run =
      std::find_if(all.begin(), all.end(), [k](const ColumnRun &run) {
        return run.begin <= k && k < run.end;
      });
    Assert(run != all.end(), ExcInternalError());
    row_values(row)[run->position + k - run->begin] += value;
  }


  void
  SystemMatrix::compress()
  {
    const MPI_Comm           comm = rows->get_mpi_communicator();
    constexpr int            tag  = 4217; // of no other messages here
    std::vector<MPI_Request> requests;
    for (Incoming &message : incoming)
      MPI_Irecv(message.buffer.data(),
                message.buffer.size(),
                MPI_DOUBLE,
                message.rank,
                tag,
                comm,
                &requests.emplace_back());
    for (const Outgoing &message : outgoing)
      MPI_Isend(ghost_values.data() + message.begin,
                message.size,
                MPI_DOUBLE,
                message.rank,
                tag,
                comm,
                &requests.emplace_back());
    MPI_Waitall(requests.size(), requests.data(), MPI_STATUSES_IGNORE);
    std::fill(ghost_values.begin(), ghost_values.end(), 0.);

    for (const Incoming &message : incoming)
      {
        const double *from = message.buffer.data();
        for (const RowGroup &theirs : message.groups)
          for (unsigned int r = 0; r < theirs.n_rows; ++r)
            {
              const unsigned int row = theirs.first_row + r;
              for_each_position(
                group(row).columns,
                theirs.columns,
                [&, to = row_values(row)](const unsigned int position,
                                          const ColumnRun   &run) {
                  for (unsigned int k = 0; k < run.length(); ++k)
                    to[position + k] += from[run.position + k];
                });
              from += theirs.row_length();
            }
      }
  }


  namespace
  {
    template <unsigned int n_rows>
    void
    multiply(const SystemMatrix &K,
             const RowGroup     &group,
             const double       *x,
             double             *y)
    {
      RowProducts<n_rows, double> products;
      const double               *rows   = K.row_values(group.first_row);
      const std::size_t           stride = group.row_length();
      for (const ColumnRun &run : group.columns)
        products.add(rows + run.position, stride, x + run.begin, run.length());
#pragma GCC unroll 4
      for (unsigned int r = 0; r < n_rows; ++r)
        y[group.first_row + r] = products[r];
    }
  } // namespace


  void
  SystemMatrix::vmult(Vector &y, const Vector &x) const
  {
    const double *from = x.begin();
    if (column_partition->n_ghost_indices() +
          column_partition->n_import_indices() >
        0)
      {
        wide.zero_out_ghost_values();
        wide.copy_locally_owned_data_from(x);
        wide.update_ghost_values();
        from = wide.begin();
      }
    for_each_owned_group([&](const RowGroup &group) {
      switch (group.n_rows)
        {
          case 1:
            return multiply<1>(*this, group, from, y.begin());
          case 2:
            return multiply<2>(*this, group, from, y.begin());
          default:
            return multiply<3>(*this, group, from, y.begin());
        }
    });
  }
} // namespace selkie
