#include <selkie/base/timer_tree.h>

#include <gtest/gtest.h>

#include <chrono>
#include <sstream>
#include <thread>


using selkie::TimerTree;

namespace
{
  void
  wait(const unsigned int milliseconds)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  }

  const TimerTree::Row &
  find(const std::vector<TimerTree::Row> &rows, const std::string &path)
  {
    for (const auto &row : rows)
      if (row.path == path)
        return row;
    throw std::runtime_error("no row " + path);
  }

  /// Two steps of two sections and 5 ms that no section covers.
  void
  run(TimerTree &timers)
  {
    for (unsigned int step = 0; step < 2; ++step)
      {
        TimerTree::Scope scope(timers, "step");
        {
          TimerTree::Scope inner(timers, "assemble");
          wait(20);
        }
        {
          TimerTree::Scope inner(timers, "solve");
          wait(10);
        }
        wait(5);
      }
  }
} // namespace

TEST(TimerTree, NestsAndShowsTheRest)
{
  TimerTree timers(MPI_COMM_SELF);
  run(timers);
  wait(3);
  const auto rows = timers.rows();

  ASSERT_EQ(rows.size(), 6u);
  const char *paths[] = {
    "total", "step", "step/assemble", "step/solve", "step/other", "other"};
  for (unsigned int i = 0; i < 6; ++i)
    EXPECT_EQ(rows[i].path, paths[i]);

  EXPECT_EQ(find(rows, "step/solve").calls, 2u);
  EXPECT_EQ(find(rows, "step/solve").depth, 2u);
  EXPECT_GE(find(rows, "step/assemble").wall, 0.04);
  EXPECT_GE(find(rows, "step/other").wall, 0.01);
  EXPECT_GE(find(rows, "other").wall, 0.003);
  EXPECT_NEAR(find(rows, "step").wall,
              rows[2].wall + rows[3].wall + rows[4].wall,
              1e-12);
  EXPECT_NEAR(rows[0].wall, rows[1].wall + rows[5].wall, 1e-12);
  EXPECT_EQ(rows[0].share, 1.);
  EXPECT_GE(timers.wall_time(), rows[0].wall);
}

TEST(TimerTree, CountsOpenSections)
{
  TimerTree        timers(MPI_COMM_SELF);
  TimerTree::Scope scope(timers, "step");
  wait(5);
  EXPECT_GE(find(timers.rows(), "step").wall, 0.005);
}

TEST(TimerTree, ClosesSectionsOnExceptions)
{
  TimerTree timers(MPI_COMM_SELF);
  try
    {
      TimerTree::Scope scope(timers, "step");
      throw 1;
    }
  catch (const int)
    {}
  TimerTree::Scope scope(timers, "output");
  EXPECT_EQ(timers.rows()[2].path, "output");
}

TEST(TimerTree, WritesCsv)
{
  TimerTree timers(MPI_COMM_SELF);
  run(timers);
  std::stringstream file;
  TimerTree::write_csv(timers.rows(), file);
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "path,calls,wall (s),cpu (s),share (%)");
  unsigned int rows = 0;
  while (std::getline(file, line))
    ++rows;
  EXPECT_EQ(rows, 6u);
}

TEST(TimerTreeMPI, MergesRanksWithDifferentSections)
{
  const auto rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  TimerTree  timers(MPI_COMM_WORLD);
  {
    TimerTree::Scope step(timers, "step");
    TimerTree::Scope inner(timers, rank == 0 ? "even" : "odd");
    wait(5);
  }
  {
    TimerTree::Scope output(timers, "output");
  }
  const auto rows = timers.rows();
  const bool one = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1;
  ASSERT_EQ(rows.size(), one ? 6u : 7u);
  EXPECT_GE(find(rows, "step/even").wall, 0.005);
  EXPECT_GE(find(rows, one ? "step/even" : "step/odd").wall, 0.005);
  EXPECT_EQ(rows.back().path, "other");
  EXPECT_EQ(rows[1].path, "step");
  EXPECT_EQ(rows[rows.size() - 2].path, "output");
}
