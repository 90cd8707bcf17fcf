#pragma once

#include <deal.II/base/mpi.h>

#include <string>

namespace selkie
{
  /// What a result was computed with.
  struct Versions
  {
    std::string selkie, git_hash, build_type;
    std::string deal_ii, trilinos, p4est;
  };

  Versions
  versions();

  /// The lines that every run begins with: versions, git hash, build type,
  /// ranks.
  std::string
  banner(const MPI_Comm comm);
} // namespace selkie
