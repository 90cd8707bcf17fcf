// One GoogleTest program for all unit tests, under MPI: rank 0 prints as
// usual, the others print their failures only, and a failure on any rank fails
// the run.
#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <iostream>

namespace
{
  class FailuresOfOtherRanks : public ::testing::EmptyTestEventListener
  {
    void
    OnTestPartResult(const ::testing::TestPartResult &result) override
    {
      if (result.failed())
        std::cout << "rank "
                  << dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD)
                  << ": " << result.file_name() << ":" << result.line_number()
                  << ": " << result.message() << std::endl;
    }
  };
} // namespace

int
main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
    {
      auto &listeners = ::testing::UnitTest::GetInstance()->listeners();
      delete listeners.Release(listeners.default_result_printer());
      listeners.Append(new FailuresOfOtherRanks);
    }
  const int failed = RUN_ALL_TESTS();
  return dealii::Utilities::MPI::max(failed, MPI_COMM_WORLD);
}
