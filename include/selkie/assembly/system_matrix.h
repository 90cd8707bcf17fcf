#pragma once

#include <selkie/base/types.h>

#include <deal.II/base/partitioner.h>
#include <deal.II/base/subscriptor.h>

#include <Epetra_CrsMatrix.h>

#include <memory>
#include <vector>

namespace selkie
{
  /// Columns of a row that follow each other, all displacements or all
  /// pressures: nodes next to each other have consecutive numbers.
  struct ColumnRun
  {
    dealii::types::global_dof_index begin = 0, end = 0; ///< [begin, end)
    bool                            pressures = false;
    unsigned int                    position  = 0; ///< of begin in its row

    unsigned int
    length() const
    {
      return end - begin;
    }
  };

  /// Rows that have the same columns: those of the displacement of a node, or
  /// that of its pressure.
  struct RowGroup
  {
    unsigned int           first_row = 0, n_rows = 0; ///< local indices
    std::vector<ColumnRun> columns;

    /// Entries of one of the rows.
    unsigned int
    row_length() const
    {
      unsigned int n = 0;
      for (const ColumnRun &run : columns)
        n += run.length();
      return n;
    }
  };

  /// Calls action(position of run.begin, run) for each run of a part of a row's
  /// columns; both ascend, and each run of the part lies in one of the row's.
  template <typename Action>
  void
  for_each_position(const std::vector<ColumnRun> &row,
                    const std::vector<ColumnRun> &part,
                    const Action                 &action)
  {
    auto in = row.begin();
    for (const ColumnRun &run : part)
      {
        while (in->end <= run.begin)
          ++in;
        action(in->position + (run.begin - in->begin), run);
      }
  }

  /// Sorts runs, and joins those of a kind that overlap or touch.
  void
  join(std::vector<ColumnRun> &runs);

  /// The union of two lists as join() makes them.
  void
  unite(const std::vector<ColumnRun> &a,
        const std::vector<ColumnRun> &b,
        std::vector<ColumnRun>       &both);

  /**
   * A matrix on the unknowns of a System, in Epetra's arrays, that knows its
   * columns as runs: entries of a dense block are found by comparing a dozen
   * runs, and products with vectors read no column indices.
   *
   * Columns have numbers of their own, those of columns(): owned unknowns as
   * they are, then all others that owned or ghost rows couple with, ascending.
   * Rows are the local indices of the unknowns: what is added to a ghost row
   * goes to its owner in compress(), one message a pair of ranks.
   */
  class SystemMatrix : public dealii::Subscriptor
  {
  public:
    using Partitioner = dealii::Utilities::MPI::Partitioner;

    /**
     * @param rows   the unknowns
     * @param groups all local rows, ascending; columns in global numbers. What
     *   the owner of a ghost row does not know of its columns, it is told.
     *   Collective.
     */
    SystemMatrix(const std::shared_ptr<const Partitioner> &rows,
                 std::vector<RowGroup>                   &&groups);

    /// Column of a local unknown.
    unsigned int
    column(const unsigned int unknown) const
    {
      return unknown < n_owned ? unknown : ghost_columns[unknown - n_owned];
    }

    /// The layout of vectors that the columns are multiplied with.
    const std::shared_ptr<const Partitioner> &
    columns() const
    {
      return column_partition;
    }

    /// The group of a local row, with column numbers.
    const RowGroup &
    group(const unsigned int row) const
    {
      return groups[group_of_row[row]];
    }

    /// The groups of the owned rows, ascending.
    template <typename Action>
    void
    for_each_owned_group(const Action &action) const
    {
      for (unsigned int i = 0; i < n_owned_groups; ++i)
        action(groups[i]);
    }

    /// The entries of a local row, at the positions of its runs.
    double *
    row_values(const unsigned int row)
    {
      return row < n_owned ? values + row_start[row]
                           : ghost_values.data() + ghost_start[row - n_owned];
    }

    const double *
    row_values(const unsigned int row) const
    {
      return const_cast<SystemMatrix *>(this)->row_values(row);
    }

    /// Sets all entries to zero.
    void
    clear();

    /// Adds to one entry, which must exist: local row and unknown.
    void
    add(const unsigned int row, const unsigned int unknown, const double value);

    /// Sends what was added to ghost rows to their owners. Collective.
    void
    compress();

    /// y = K x in the owned rows. Collective.
    void
    vmult(Vector &y, const Vector &x) const;

    /// For Trilinos: the owned rows.
    const Epetra_CrsMatrix &
    epetra() const
    {
      return *matrix;
    }

    unsigned long long
    n_nonzero_elements() const
    {
      return matrix->NumGlobalNonzeros64();
    }

  private:
    void
    place_ghost_values();
    void
    exchange_columns();
    void
    number_columns();
    void
    make_epetra_matrix();

    /// What comes from another rank: rows of ours, with their columns there.
    struct Incoming
    {
      unsigned int          rank;
      std::vector<RowGroup> groups;
      std::vector<double>   buffer;
    };
    /// Values of ghost rows that go to their owner.
    struct Outgoing
    {
      unsigned int rank;
      std::size_t  begin, size;
    };

    const std::shared_ptr<const Partitioner> rows;
    std::shared_ptr<const Partitioner>       column_partition;
    const unsigned int                       n_owned;
    std::vector<RowGroup>                    groups; ///< owned, then ghosts
    unsigned int                             n_owned_groups = 0;
    std::vector<unsigned int>                group_of_row, ghost_columns;

    std::unique_ptr<Epetra_CrsMatrix> matrix;
    int                              *row_start = nullptr;
    double                           *values    = nullptr;

    std::vector<std::size_t> ghost_start; ///< by ghost row, and the end
    std::vector<double>      ghost_values;
    std::vector<Incoming>    incoming;
    std::vector<Outgoing>    outgoing;
    mutable Vector           wide; ///< a vector with all columns
  };
} // namespace selkie
