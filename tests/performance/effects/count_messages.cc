/**
 * @file
 * A library to preload: counts the MPI messages and collective calls of a
 * program through MPI's profiling interface and writes the totals of each rank
 * to $SELKIE_MESSAGES.<rank> when MPI ends. Nothing of it is in the program.
 *
 * First line: messages, their bytes, collective calls. Second line: those of
 * the collective calls whose answer grows with the number of ranks, and the
 * bytes that a rank puts into them. Third line: messages to each rank.
 */
#include <mpi.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

namespace
{
  long                messages = 0, bytes = 0, collectives = 0;
  long                gathers = 0, gathered = 0;
  std::map<int, long> partners; ///< messages by rank of the world

  long
  size_of(const int n, const MPI_Datatype type)
  {
    int size = 0;
    PMPI_Type_size(type, &size);
    return long(n) * size;
  }

  int
  world_rank(const int rank, const MPI_Comm comm)
  {
    MPI_Group group, world;
    int       result = rank;
    PMPI_Comm_group(comm, &group);
    PMPI_Comm_group(MPI_COMM_WORLD, &world);
    PMPI_Group_translate_ranks(group, 1, &rank, world, &result);
    PMPI_Group_free(&group);
    PMPI_Group_free(&world);
    return result;
  }

  void
  count(const int n, const MPI_Datatype type, const int to, const MPI_Comm comm)
  {
    ++messages;
    bytes += size_of(n, type);
    ++partners[world_rank(to, comm)];
  }

  /// A call whose answer grows with the number of ranks.
  void
  count_gather(const int n, const MPI_Datatype type)
  {
    ++gathers;
    gathered += size_of(n, type);
  }
} // namespace

#define COLLECTIVE(NAME, PARAMETERS, ARGUMENTS) \
  int MPI_##NAME PARAMETERS                     \
  {                                             \
    ++collectives;                              \
    return PMPI_##NAME ARGUMENTS;               \
  }

// n and t: what a rank puts in.
#define GATHER(NAME, PARAMETERS, ARGUMENTS) \
  int MPI_##NAME PARAMETERS                 \
  {                                         \
    ++collectives;                          \
    count_gather(n, t);                     \
    return PMPI_##NAME ARGUMENTS;           \
  }

extern "C"
{
  int
  MPI_Send(const void  *buffer,
           int          n,
           MPI_Datatype type,
           int          to,
           int          tag,
           MPI_Comm     comm)
  {
    count(n, type, to, comm);
    return PMPI_Send(buffer, n, type, to, tag, comm);
  }

  int
  MPI_Rsend(const void  *buffer,
            int          n,
            MPI_Datatype type,
            int          to,
            int          tag,
            MPI_Comm     comm)
  {
    count(n, type, to, comm);
    return PMPI_Rsend(buffer, n, type, to, tag, comm);
  }

  int
  MPI_Isend(const void  *buffer,
            int          n,
            MPI_Datatype type,
            int          to,
            int          tag,
            MPI_Comm     comm,
            MPI_Request *request)
  {
    count(n, type, to, comm);
    return PMPI_Isend(buffer, n, type, to, tag, comm, request);
  }

  int
  MPI_Issend(const void  *buffer,
             int          n,
             MPI_Datatype type,
             int          to,
             int          tag,
             MPI_Comm     comm,
             MPI_Request *request)
  {
    count(n, type, to, comm);
    return PMPI_Issend(buffer, n, type, to, tag, comm, request);
  }

  COLLECTIVE(Barrier, (MPI_Comm comm), (comm))
  COLLECTIVE(Ibarrier, (MPI_Comm comm, MPI_Request *r), (comm, r))
  COLLECTIVE(Bcast,
             (void *b, int n, MPI_Datatype t, int root, MPI_Comm c),
             (b, n, t, root, c))
  COLLECTIVE(
    Allreduce,
    (const void *s, void *r, int n, MPI_Datatype t, MPI_Op op, MPI_Comm c),
    (s, r, n, t, op, c))
  COLLECTIVE(Reduce,
             (const void  *s,
              void        *r,
              int          n,
              MPI_Datatype t,
              MPI_Op       op,
              int          root,
              MPI_Comm     c),
             (s, r, n, t, op, root, c))
  GATHER(Allgather,
         (const void  *s,
          int          n,
          MPI_Datatype t,
          void        *r,
          int          m,
          MPI_Datatype u,
          MPI_Comm     c),
         (s, n, t, r, m, u, c))
  GATHER(Allgatherv,
         (const void  *s,
          int          n,
          MPI_Datatype t,
          void        *r,
          const int   *m,
          const int   *d,
          MPI_Datatype u,
          MPI_Comm     c),
         (s, n, t, r, m, d, u, c))
  GATHER(Alltoall,
         (const void  *s,
          int          n,
          MPI_Datatype t,
          void        *r,
          int          m,
          MPI_Datatype u,
          MPI_Comm     c),
         (s, n, t, r, m, u, c))
  GATHER(Gather,
         (const void  *s,
          int          n,
          MPI_Datatype t,
          void        *r,
          int          m,
          MPI_Datatype u,
          int          root,
          MPI_Comm     c),
         (s, n, t, r, m, u, root, c))
  GATHER(Gatherv,
         (const void  *s,
          int          n,
          MPI_Datatype t,
          void        *r,
          const int   *m,
          const int   *d,
          MPI_Datatype u,
          int          root,
          MPI_Comm     c),
         (s, n, t, r, m, d, u, root, c))
  GATHER(Reduce_scatter_block,
         (const void *s, void *r, int n, MPI_Datatype t, MPI_Op op, MPI_Comm c),
         (s, r, n, t, op, c))
  COLLECTIVE(Reduce_scatter,
             (const void  *s,
              void        *r,
              const int   *n,
              MPI_Datatype t,
              MPI_Op       op,
              MPI_Comm     c),
             (s, r, n, t, op, c))
  COLLECTIVE(
    Exscan,
    (const void *s, void *r, int n, MPI_Datatype t, MPI_Op op, MPI_Comm c),
    (s, r, n, t, op, c))
  COLLECTIVE(
    Scan,
    (const void *s, void *r, int n, MPI_Datatype t, MPI_Op op, MPI_Comm c),
    (s, r, n, t, op, c))

  int
  MPI_Finalize()
  {
    int rank = 0;
    PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (const char *path = std::getenv("SELKIE_MESSAGES"))
      {
        std::ofstream out(std::string(path) + "." + std::to_string(rank));
        out << messages << ' ' << bytes << ' ' << collectives << '\n'
            << gathers << ' ' << gathered << '\n';
        int n_ranks = 0;
        PMPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
        for (int other = 0; other < n_ranks; ++other)
          out << (other > 0 ? " " : "") << partners[other];
        out << '\n';
      }
    return PMPI_Finalize();
  }
}
