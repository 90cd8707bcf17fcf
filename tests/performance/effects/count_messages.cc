/**
 * @file
 * A library to preload: counts the MPI messages and collective calls of a
 * program through MPI's profiling interface and writes the totals of each rank
 * to $SELKIE_MESSAGES.<rank> when MPI ends. Nothing of it is in the program.
 */
#include <mpi.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace
{
  long messages = 0, bytes = 0, collectives = 0;

  void
  count(const int n, const MPI_Datatype type)
  {
    int size = 0;
    PMPI_Type_size(type, &size);
    ++messages;
    bytes += long(n) * size;
  }
} // namespace

#define COLLECTIVE(NAME, PARAMETERS, ARGUMENTS) \
  int MPI_##NAME PARAMETERS                     \
  {                                             \
    ++collectives;                              \
    return PMPI_##NAME ARGUMENTS;               \
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
    count(n, type);
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
    count(n, type);
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
    count(n, type);
    return PMPI_Isend(buffer, n, type, to, tag, comm, request);
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
  COLLECTIVE(Allgather,
             (const void  *s,
              int          n,
              MPI_Datatype t,
              void        *r,
              int          m,
              MPI_Datatype u,
              MPI_Comm     c),
             (s, n, t, r, m, u, c))
  COLLECTIVE(Allgatherv,
             (const void  *s,
              int          n,
              MPI_Datatype t,
              void        *r,
              const int   *m,
              const int   *d,
              MPI_Datatype u,
              MPI_Comm     c),
             (s, n, t, r, m, d, u, c))
  COLLECTIVE(Alltoall,
             (const void  *s,
              int          n,
              MPI_Datatype t,
              void        *r,
              int          m,
              MPI_Datatype u,
              MPI_Comm     c),
             (s, n, t, r, m, u, c))
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
      std::ofstream(std::string(path) + "." + std::to_string(rank))
        << messages << ' ' << bytes << ' ' << collectives << '\n';
    return PMPI_Finalize();
  }
}
