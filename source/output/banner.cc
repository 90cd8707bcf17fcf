#include <selkie/output/banner.h>
#include <selkie/version.h>

#include <deal.II/base/config.h>

namespace selkie
{
  Versions
  versions()
  {
    const auto dotted =
      [](const unsigned int a, const unsigned int b, const unsigned int c) {
        return std::to_string(a) + '.' + std::to_string(b) + '.' +
               std::to_string(c);
      };
    return {SELKIE_VERSION,
            SELKIE_GIT_HASH,
            SELKIE_BUILD_TYPE,
            DEAL_II_PACKAGE_VERSION,
            dotted(DEAL_II_TRILINOS_VERSION_MAJOR,
                   DEAL_II_TRILINOS_VERSION_MINOR,
                   DEAL_II_TRILINOS_VERSION_SUBMINOR),
            dotted(DEAL_II_P4EST_VERSION_MAJOR,
                   DEAL_II_P4EST_VERSION_MINOR,
                   DEAL_II_P4EST_VERSION_SUBMINOR)};
  }


  std::string
  banner(const MPI_Comm comm)
  {
    const Versions     v = versions();
    const unsigned int n = dealii::Utilities::MPI::n_mpi_processes(comm);
    return "Selkie " + v.selkie + ", git " + v.git_hash + ", " + v.build_type +
           " build, " + std::to_string(n) + (n == 1 ? " rank" : " ranks") +
           "\nwith deal.II " + v.deal_ii + ", Trilinos " + v.trilinos +
           ", p4est " + v.p4est;
  }
} // namespace selkie
