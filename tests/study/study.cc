#include <selkie/base/exceptions.h>
#include <selkie/study/convergence.h>
#include <selkie/study/measure.h>
#include <selkie/study/study.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "../temporary_folder.h"

using namespace selkie;

TEST(Study, VaryIsAProductAndCarriesNames)
{
  const auto members =
    vary("Domain/Cells=8, 8 & Time/Step=0.1 | Domain/Cells=16, 16 & "
         "Time/Step=0.05; LME/Gamma=0.8 | 3");
  ASSERT_EQ(members.size(), 4u);
  EXPECT_EQ(members[1],
            (Settings{"Domain/Cells=8, 8", "Time/Step=0.1", "LME/Gamma=3"}));
  EXPECT_EQ(
    members[2],
    (Settings{"Domain/Cells=16, 16", "Time/Step=0.05", "LME/Gamma=0.8"}));
  EXPECT_EQ(vary("").size(), 1u); // one member, as the scene is
  EXPECT_THROW(vary("8 | 16"), SceneError);
}

TEST(Study, OrdersOfAPowerLaw)
{
  std::vector<CostAndError> points;
  for (const double h : {0.1, 0.4, 0.2, 0.05}) // in any order
    points.push_back({h, 1. / h, 3. * h * h});
  for (const double order : observed_orders(points))
    EXPECT_NEAR(order, 2., 1e-12);
  EXPECT_NEAR(fitted_order(points), 2., 1e-12);
  // A coarse member outside of the asymptotic range does not count.
  points.push_back({0.8, 1., 0.5});
  EXPECT_NEAR(fitted_order(points), 2., 1e-12);
  // Errors that stop falling have no order.
  EXPECT_TRUE(std::isnan(
    fitted_order({{0.4, 1, 0.16}, {0.2, 2, 0.04}, {0.1, 4, 0.039}})));
}

TEST(Study, ParetoFrontAndTimes)
{
  const std::vector<CostAndError> points = {{1, 1., 0.1},
                                            {1, 4., 0.01},
                                            {1, 2., 0.2},
                                            {1, 8., 0.01}};
  EXPECT_EQ(pareto_front(points),
            (std::vector<bool>{true, true, false, false}));
  // Half way in the logarithms.
  EXPECT_NEAR(time_to_reach(points, std::sqrt(0.001)), 2., 1e-12);
  EXPECT_EQ(time_to_reach(points, 0.5), 1.);
  EXPECT_TRUE(std::isnan(time_to_reach(points, 1e-3)));
}

TEST(Study, ErrorsAgainstValueFunctionAndFile)
{
  const TemporaryFolder folder;
  std::ofstream(folder.path + "/statistics.csv")
    << "time (s),x (m)\n0,1\n0.5,1.6\n1,2.2\n";
  std::ofstream(folder.path + "/reference.csv") << "t (s),x (m)\n0,1\n1,2\n";
  StudyQuantity quantity;
  quantity.column   = "x";
  const Curve curve = read_curve(quantity, folder.path);
  EXPECT_NEAR(error_of(curve, quantity, ""), 2.2, 1e-15); // is the error
  quantity.scale = 2.;
  EXPECT_NEAR(error_of(curve, quantity, ""), 1.1, 1e-15);
  quantity.value = 2.;
  EXPECT_NEAR(error_of(curve, quantity, ""), 0.1, 1e-15);
  quantity.value.reset();
  quantity.file = folder.path + "/reference.csv";
  EXPECT_NEAR(error_of(curve, quantity, ""), 0.1, 1e-15);
  quantity.reduction     = Reduction::rms;
  const double reference = std::sqrt((1. + 1.5 * 1.5 + 4.) / 3.);
  EXPECT_NEAR(error_of(curve, quantity, ""),
              std::sqrt((0.01 + 0.04) / 3.) / reference,
              1e-14);
  quantity.file.clear();
  quantity.function = "1 + t";
  EXPECT_NEAR(error_of(curve, quantity, ""),
              std::sqrt((0.01 + 0.04) / 3.) / reference,
              1e-14);
  quantity.column = "y";
  EXPECT_THROW(read_curve(quantity, folder.path), SceneError);
}

TEST(Study, IsReadAndRefused)
{
  const TemporaryFolder folder;
  const std::string     file = folder.path + "/a study.prm";
  const std::string     text = "subsection Study\n"
                               "  set Scene  = ../scene.prm\n"
                               "  set Series = one, two words\n"
                               "  subsection Quantity\n"
                               "    set Column = x\n"
                               "  end\n"
                               "  subsection one\n"
                               "    set Vary = LME/Gamma = 1 | 2\n"
                               "  end\n"
                               "  subsection two words\n"
                               "    set Settings = Approximation=q4 fem\n"
                               "  end\n"
                               "end\n";
  std::ofstream(file) << text;
  const Study study =
    read_study(file, {"Time/Step=2", "Output/Directory=elsewhere"});
  EXPECT_EQ(study.directory, "elsewhere");
  ASSERT_EQ(study.members.size(), 3u);
  EXPECT_EQ(study.members[1].name, "one-02");
  EXPECT_EQ(study.members[2].name, "two_words-01");
  EXPECT_EQ(study.members[2].settings,
            (Settings{"Approximation=q4 fem", "Time/Step=2"}));

  std::ofstream(file) << text << "subsection Study\n set Sries = 1\nend\n";
  EXPECT_THROW(read_study(file, {}), SceneError);
  std::ofstream(file) << "set Dimension = 2\n";
  EXPECT_THROW(read_study(file, {}), SceneError);
  std::ofstream(file) << text;
  EXPECT_THROW(read_study(file,
                          {"Study/Quantity/Reference value=1",
                           "Study/Quantity/Reference function=t"}),
               SceneError);
  EXPECT_THROW(read_study(file, {"Study/Quantity/Reference value=one"}),
               SceneError);
}
