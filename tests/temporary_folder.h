#pragma once

#include <deal.II/base/mpi.h>

#include <cstdlib>
#include <filesystem>
#include <string>

/// A new empty folder, known to all ranks of comm and removed at the end.
class TemporaryFolder
{
public:
  explicit TemporaryFolder(const MPI_Comm comm = MPI_COMM_SELF)
    : comm(comm)
    , root(dealii::Utilities::MPI::this_mpi_process(comm) == 0)
  {
    std::string pattern =
      (std::filesystem::temp_directory_path() / "selkie-XXXXXX").string();
    if (root)
      path = mkdtemp(&pattern[0]);
    path = dealii::Utilities::MPI::broadcast(comm, path);
  }

  ~TemporaryFolder()
  {
    MPI_Barrier(comm);
    if (root)
      std::filesystem::remove_all(path);
  }

  TemporaryFolder(const TemporaryFolder &) = delete;
  TemporaryFolder &
  operator=(const TemporaryFolder &) = delete;

  std::string path;

private:
  const MPI_Comm comm;
  const bool     root;
};
