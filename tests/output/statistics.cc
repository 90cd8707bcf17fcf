#include <selkie/output/statistics.h>

#include <deal.II/base/exceptions.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "../temporary_folder.h"

namespace
{
  std::string
  content(const std::string &path)
  {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
} // namespace

TEST(Statistics, FirstRowFixesTheColumns)
{
  const TemporaryFolder folder;
  const std::string     path = folder.path + "/statistics.csv";
  selkie::Statistics    statistics;
  statistics.open(path, true);

  statistics.set("step", 1u);
  statistics.set("time (s)", 0.1);
  statistics.set("points", 12345678901ull);
  statistics.end_row();
  // Any order; a value that is not set is nan.
  statistics.set("points", 5);
  statistics.set("step", 2u);
  statistics.end_row();

  EXPECT_EQ(content(path),
            "step,time (s),points\n"
            "1,0.10000000000000001,12345678901\n"
            "2,nan,5\n");
  EXPECT_THROW(statistics.set("late", 1.), dealii::ExceptionBase);
}

TEST(Statistics, KeepsEveryDigit)
{
  const TemporaryFolder folder;
  const std::string     path  = folder.path + "/statistics.csv";
  const double          value = std::nextafter(M_PI, 4.);
  selkie::Statistics    statistics;
  statistics.open(path, true);
  statistics.set("value", value);
  statistics.end_row();
  EXPECT_EQ(std::stod(content(path).substr(6)), value);
}

TEST(Statistics, OnlyTheRootWrites)
{
  const TemporaryFolder folder;
  const std::string     path = folder.path + "/statistics.csv";
  selkie::Statistics    statistics;
  statistics.open(path, false);
  statistics.set("step", 1u);
  statistics.end_row();
  EXPECT_FALSE(std::ifstream(path));
}

TEST(Statistics, NamesAFileThatCannotBeWritten)
{
  selkie::Statistics statistics;
  try
    {
      statistics.open("/nowhere/statistics.csv", true);
      FAIL();
    }
  catch (const std::runtime_error &e)
    {
      EXPECT_NE(std::string(e.what()).find("/nowhere/statistics.csv"),
                std::string::npos);
    }
}
