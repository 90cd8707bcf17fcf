// Boost 1.74's property tree notes its own use of bind otherwise.
#define BOOST_BIND_GLOBAL_PLACEHOLDERS
#include <selkie/base/exceptions.h>
#include <selkie/base/log.h>
#include <selkie/output/banner.h>
#include <selkie/output/files.h>
#include <selkie/output/json.h>
#include <selkie/output/output_folder.h>
#include <selkie/output/summary.h>

#include <boost/property_tree/json_parser.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "../temporary_folder.h"

using namespace selkie;
namespace fs = std::filesystem;

TEST(OutputFolderMPI, HoldsBothParameterFiles)
{
  const TemporaryFolder base(MPI_COMM_WORLD);
  const std::string     scene = base.path + "/scene.prm";
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    write_text(scene, "set A = 1\n");
  const std::string folder = base.path + "/some/where";
  create_output_folder(folder, scene, "set A = 1\nset B = 2\n", MPI_COMM_WORLD);
  EXPECT_EQ(read_text(folder + "/original.prm"), "set A = 1\n");
  EXPECT_EQ(read_text(folder + "/parameters.prm"), "set A = 1\nset B = 2\n");
  EXPECT_TRUE(fs::is_directory(folder + "/solution"));
  EXPECT_TRUE(fs::is_directory(folder + "/probes"));
}

TEST(OutputFolder, ARerunRemovesOnlyWhatIsOurs)
{
  const TemporaryFolder base;
  const std::string     scene  = base.path + "/scene.prm";
  const std::string     folder = base.path + "/out";
  write_text(scene, "text");
  create_output_folder(folder, scene, "all", MPI_COMM_SELF);
  const char *ours[]   = {"solution/particles_0001.0.vtu",
                          "solution/mesh_0001.pvtu",
                          "probes/tip.csv",
                          "particles.pvd",
                          "statistics.csv",
                          "summary.json"};
  const char *theirs[] = {"notes.txt", "solution/picture.png", "probes/tip.gp"};
  for (const char *name : ours)
    write_text(folder + '/' + name, "old");
  for (const char *name : theirs)
    write_text(folder + '/' + name, "old");

  // The copy of an earlier run is a scene like any other.
  create_output_folder(folder, folder + "/original.prm", "all", MPI_COMM_SELF);
  for (const char *name : ours)
    EXPECT_FALSE(fs::exists(folder + '/' + name)) << name;
  for (const char *name : theirs)
    EXPECT_TRUE(fs::exists(folder + '/' + name)) << name;
  EXPECT_EQ(read_text(folder + "/original.prm"), "text");
}

TEST(OutputFolderMPI, OneThatCannotBeWrittenIsNamedOnAllRanks)
{
  const TemporaryFolder base(MPI_COMM_WORLD);
  const std::string     file = base.path + "/scene.prm";
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    write_text(file, "text");
  try
    {
      create_output_folder(file + "/out", file, "", MPI_COMM_WORLD);
      FAIL();
    }
  catch (const SceneError &error)
    {
      EXPECT_NE(std::string(error.what()).find(file + "/out"),
                std::string::npos);
    }
}

TEST(Log, FileStartsWithWhatWasSaidBefore)
{
  const TemporaryFolder folder;
  testing::internal::CaptureStdout();
  {
    Log log(MPI_COMM_SELF);
    log.line("one");
    log.open(folder.path);
    log.line("two");
    log.progress("three");
  }
  const std::string screen = testing::internal::GetCapturedStdout();
  EXPECT_EQ(read_text(folder.path + "/log.txt"), "one\ntwo\nthree\n");
  EXPECT_EQ(screen, "one\ntwo\nthree\n"); // captured: not a terminal
}

TEST(Banner, NamesVersionsAndRanks)
{
  const std::string text = banner(MPI_COMM_SELF);
  for (const char *word : {"Selkie", "git", "deal.II 9.", "p4est", "1 rank"})
    EXPECT_NE(text.find(word), std::string::npos) << word;
}

TEST(Summary, IsJson)
{
  Summary summary;
  summary.title   = "a \"quoted\" title,\nin two lines \\";
  summary.effects = {"inertia", "gravity"};
  summary.steps   = 12;
  summary.audit.emplace();
  summary.audit->kinetic = 0.1;
  summary.audit->min_J   = std::numeric_limits<double>::infinity();
  summary.timings        = {{"total", 0, 1, 2.5, 2.4, 1.}};

  const TemporaryFolder folder;
  const std::string     path = folder.path + "/summary.json";
  write_summary(path, summary);
  boost::property_tree::ptree json;
  boost::property_tree::read_json(path, json);
  EXPECT_EQ(json.get<std::string>("title"), summary.title);
  EXPECT_EQ(json.get<std::string>("verdict"), "done");
  EXPECT_EQ(json.get_child("effects").size(), 2u);
  EXPECT_EQ(json.get<unsigned int>("steps"), 12u);
  EXPECT_EQ(json.get<double>("final figures.kinetic energy"), 0.1);
  EXPECT_EQ(json.get<std::string>("final figures.min J"), "null");
  EXPECT_EQ(json.get_child("timings").front().second.get<double>("wall (s)"),
            2.5);
  // Numbers are numbers.
  EXPECT_NE(read_text(path).find("\"steps\": 12,"), std::string::npos);

  summary.failure = "a point leaves the domain";
  write_summary(path, summary);
  boost::property_tree::read_json(path, json);
  EXPECT_EQ(json.get<std::string>("verdict"), "failure");
}
