#include <selkie/solver/mumps.h>

#include <Epetra_MpiComm.h>
#include <Epetra_Vector.h>

namespace selkie
{
  namespace
  {
    // MUMPS's own names and numbers (user's guide 5.5, sections 5 and 6).
    enum Job
    {
      initialise = -1,
      finish     = -2,
      analyse    = 1,
      factorise  = 2,
      solve      = 3
    };

    int &
    icntl(DMUMPS_STRUC_C &mumps, const unsigned int number)
    {
      return mumps.icntl[number - 1];
    }
  } // namespace


  Mumps::Mumps(const Epetra_CrsMatrix &K, const bool symmetric)
    : K(K)
    , on_first_rank(-1,
                    K.Comm().MyPID() == 0 ? K.NumGlobalRows() : 0,
                    0,
                    K.Comm())
    , to_first_rank(on_first_rank, K.RowMap())
    , mumps()
  {
    const auto &comm   = dynamic_cast<const Epetra_MpiComm &>(K.Comm());
    mumps.comm_fortran = MPI_Comm_c2f(comm.Comm());
    mumps.par          = 1; // the first rank works, too
    mumps.sym          = symmetric ? 2 : 0;
    run(initialise);
    for (const unsigned int output : {1, 2, 3, 4})
      icntl(mumps, output) = 0;
    icntl(mumps, 18) = 3; // each rank has its own entries

    int    *start, *column;
    double *value;
    K.ExtractCrsDataPointers(start, column, value);
    for (int i = 0; i < K.NumMyRows(); ++i)
      for (int k = start[i]; k < start[i + 1]; ++k)
        if (!symmetric || K.GCID(column[k]) <= K.GRID(i))
          {
            rows.push_back(K.GRID(i) + 1);
            columns.push_back(K.GCID(column[k]) + 1);
            places.push_back(k);
          }
    values.resize(places.size());
    mumps.n       = K.NumGlobalRows();
    mumps.nnz_loc = places.size();
    mumps.irn_loc = rows.data();
    mumps.jcn_loc = columns.data();
    mumps.a_loc   = values.data();
    run(analyse);
  }


  Mumps::~Mumps()
  {
    run(finish);
  }


  int
  Mumps::run(const int job)
  {
    mumps.job = job;
    dmumps_c(&mumps);
    return mumps.infog[0];
  }


  int
  Mumps::factorise(const int room)
  {
    if (mumps.infog[0] < 0 && mumps.job == analyse)
      return mumps.infog[0];
    int    *start, *column;
    double *value;
    K.ExtractCrsDataPointers(start, column, value);
    for (std::size_t i = 0; i < places.size(); ++i)
      values[i] = value[places[i]];
    icntl(mumps, 14) = room;
    return run(Job::factorise);
  }


  int
  Mumps::solve(double *x, const double *b)
  {
    const Epetra_Vector rhs(View, K.RowMap(), const_cast<double *>(b));
    Epetra_Vector       whole(on_first_rank);
    whole.Import(rhs, to_first_rank, Insert);
    mumps.rhs       = whole.Values(); // the solution takes its place
    const int error = run(Job::solve);
    mumps.rhs       = nullptr;
    if (error < 0)
      return error;
    Epetra_Vector solution(View, K.RowMap(), x);
    solution.Export(whole, to_first_rank, Insert);
    return error;
  }
} // namespace selkie
