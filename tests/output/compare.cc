#include <selkie/base/exceptions.h>
#include <selkie/output/compare.h>
#include <selkie/output/compare_curves.h>
#include <selkie/output/compare_fields.h>
#include <selkie/output/files.h>
#include <selkie/output/point_sampler.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "../temporary_folder.h"

using namespace selkie;
namespace fs = std::filesystem;

namespace
{
  bool
  any_column(const std::string &)
  {
    return true;
  }

  TableFile
  curve(const std::vector<double> &times, const std::vector<double> &values)
  {
    return {"curve.csv", {"time (s)", "u (m)"}, {times, values}};
  }

  /// f = 2 + 3 x - y + z and its multiples, at a reference lattice that is
  /// moved and scaled in space.
  template <int dim>
  PointData
  linear_field(const unsigned int n)
  {
    PointData  data;
    PointField X{"reference position", "m", 3, {}};
    PointField v{"velocity", "m/s", 3, {}};
    PointField J{"volume ratio", "", 1, {}};
    for (unsigned int i = 0; i < std::pow(n, dim); ++i)
      {
        double             f = 2.;
        dealii::Point<3>   place;
        const unsigned int index[] = {i % n, i / n % n, i / n / n};
        for (unsigned int d = 0; d < dim; ++d)
          {
            place[d] = (index[d] + 0.5) / n;
            f += (d == 0 ? 3. : d == 1 ? -1. : 1.) * place[d];
          }
        X.values.insert(X.values.end(), {place[0], place[1], place[2]});
        v.values.insert(v.values.end(), {f, -2. * f, 0.});
        J.values.push_back(f);
        data.positions.push_back(dealii::Point<3>(n * place));
      }
    data.fields = {X, v, J};
    return data;
  }

  BodyPoints
  all_points(const PointData &data)
  {
    BodyPoints body{&data, {}};
    for (std::size_t i = 0; i < data.positions.size(); ++i)
      body.points.push_back(i);
    return body;
  }

  /// An output folder as a run of that dimension leaves it, without pictures.
  std::string
  make_run(const std::string &path,
           const std::string &dimension,
           const std::string &statistics)
  {
    fs::create_directories(path + "/probes");
    write_text(path + "/parameters.prm",
               "set Dimension = " + dimension +
                 "\nset New parameter = 1\nsubsection Bodies\n"
                 "  set Names = water, block\n  subsection water\n"
                 "    set Law = newtonian fluid\n  end\nend\n");
    write_text(path + "/statistics.csv", statistics);
    write_text(path + "/summary.json", "{\"failure\": \"\"}");
    return path;
  }

  const std::string some_statistics =
    "step,time (s),kinetic energy (J/m)\n1,0.5,2\n2,1,4\n";

  template <typename Call>
  std::string
  refusal(const Call &call)
  {
    try
      {
        call();
      }
    catch (const SceneError &error)
      {
        return error.what();
      }
    return "";
  }
} // namespace

TEST(CompareCurves, KnownDifference)
{
  // B is 0 at 0 and 4 at 4; on A's times 1, 2 and 3 it is A but for 0.5 at 2.
  const TableFile a = curve({-1., 1., 2., 3., 5.}, {9., 1., 2.5, 3., 9.});
  const TableFile b = curve({0., 4.}, {0., 4.});
  const auto      d = compare_curves("probe tip", a, b, any_column);
  ASSERT_EQ(d.size(), 1u);
  EXPECT_EQ(d[0].quantity, "u (m)");
  EXPECT_TRUE(std::isnan(d[0].time));
  EXPECT_NEAR(d[0].largest, 0.5, 1e-14);
  EXPECT_EQ(d[0].largest_time, 2.);
  EXPECT_EQ(d[0].scale, 3.);
  const double a2 = 0.5 * 1. + 1. * 2.5 * 2.5 + 0.5 * 9.;
  EXPECT_NEAR(d[0].relative_L2, std::sqrt(0.25 / a2), 1e-14);
}

TEST(CompareCurves, EqualZeroNoNumberAndNoCommonTime)
{
  const double    nan = std::nan("");
  const TableFile a   = curve({0., 1., 2.}, {0., 0., 0.});
  const auto      d   = compare_curves("", a, a, any_column);
  ASSERT_EQ(d.size(), 1u);
  EXPECT_EQ(d[0].relative_L2, 0.);
  const TableFile one = curve({0., 1., 2.}, {0., 1., nan});
  const auto      e   = compare_curves("", a, one, any_column);
  ASSERT_EQ(e.size(), 1u);
  EXPECT_TRUE(std::isinf(e[0].relative_L2));
  EXPECT_EQ(e[0].largest, 1.);
  EXPECT_TRUE(
    compare_curves("", a, curve({3., 4.}, {0., 0.}), any_column).empty());
  EXPECT_TRUE(
    compare_curves("", a, curve({0., 1.}, {nan, nan}), any_column).empty());
}

TEST(CompareCurves, PhysicalColumns)
{
  for (const char *name : {"kinetic energy (J/m)", "min J", "volume (m^2)"})
    EXPECT_TRUE(is_physical(name)) << name;
  for (const char *name :
       {"time (s)", "dt (s)", "step", "newton iterations", "points"})
    EXPECT_FALSE(is_physical(name)) << name;
}

TEST(CompareFields, LinearFieldOnAnotherLattice)
{
  const PointData a2 = linear_field<2>(7), b2 = linear_field<2>(10);
  const PointData a3 = linear_field<3>(5), b3 = linear_field<3>(4);
  for (const auto &fields :
       {compare_body<2>(all_points(a2), all_points(b2), 1.),
        compare_body<3>(all_points(a3), all_points(b3), 1.)})
    {
      ASSERT_EQ(fields.size(), 2u);
      EXPECT_EQ(fields[0].quantity, "velocity (m/s)");
      EXPECT_EQ(fields[1].quantity, "volume ratio");
      for (const FieldSums &field : fields)
        {
          EXPECT_TRUE(field.varies);
          EXPECT_LT(field.sums.result("", "").relative_L2, 1e-12);
          EXPECT_LT(field.sums.largest, 1e-12);
        }
    }
}

TEST(CompareFields, KnownDifferenceWeightedWithVolume)
{
  PointData a = linear_field<2>(4), b = a;
  a.fields.push_back({"reference volume", "m^2", 1, {}});
  a.fields.back().values.assign(16, 1.);
  a.fields.back().values[3] = 5.;
  a.fields[2].values.assign(16, 2.);
  b.fields[2].values    = a.fields[2].values;
  b.fields[2].values[3] = 2.5;
  const auto fields     = compare_body<2>(all_points(a), all_points(b), 0.1);
  const auto J          = fields[1].sums.result("body a", "J");
  EXPECT_NEAR(J.largest, 0.5, 1e-9);
  EXPECT_NEAR(J.relative_L2, std::sqrt(5. * 0.25 / (20. * 4.)), 1e-9);
  EXPECT_LT(fields[0].sums.largest, 1e-12);
}

TEST(CompareFields, Times)
{
  const TimePairs pairs =
    pair_times({0., 0.1, 0.2, 0.3, 0.4}, {0.01, 0.16, 0.31});
  EXPECT_EQ(pairs, (TimePairs{{0, 0}, {2, 1}, {3, 2}}));
  EXPECT_EQ(pair_times({0.5}, {0., 0.5}), (TimePairs{{0, 1}}));
  EXPECT_TRUE(pair_times({0.5}, {}).empty());
}

TEST(PointSampler, PointsInALineGiveTheNearest)
{
  const PointSampler<2> line(
    {{0., 0.}, {1., 1e-9}, {2., 0.}, {3., 0.}, {4., 0.}, {5., 0.}});
  const auto stencil = line.stencil({2.2, 1.});
  ASSERT_EQ(stencil.size(), 1u);
  EXPECT_EQ(stencil[0].first, 2u);
  EXPECT_EQ(PointSampler<3>({{1., 1., 1.}}).stencil({1., 1., 1.}).size(), 1u);
}

TEST(Compare, WritesItsFileAndNoOther)
{
  const TemporaryFolder base;
  const std::string     a = make_run(base.path + "/a", "2", some_statistics);
  const std::string     b = make_run(base.path + "/b",
                                 "2",
                                 "step,time (s),kinetic energy (J/m)\n"
                                     "1,1,3\n");
  const Comparison      comparison = compare_runs(a, b + "/");
  EXPECT_EQ(comparison.b.bodies, (std::vector<std::string>{"water", "block"}));
  ASSERT_EQ(comparison.differences.size(), 1u);
  EXPECT_EQ(comparison.differences[0].relative_L2, 0.25);
  EXPECT_NE(comparison_table(comparison).find("2.500e-01"), std::string::npos);

  EXPECT_EQ(write_comparison(comparison), a + "/compare_b/compare.csv");
  EXPECT_EQ(write_comparison(comparison), a + "/compare_b/compare.csv");
  EXPECT_NE(read_text(a + "/compare_b/compare.csv")
              .find("\nstatistics,kinetic energy (J/m),all,0.25,1,1,4\n"),
            std::string::npos);

  write_text(base.path + "/compare.csv", "mine");
  const auto into = [&](const std::string &directory) {
    return refusal([&] { write_comparison(comparison, directory); });
  };
  EXPECT_NE(into(base.path).find("other content"), std::string::npos);
  EXPECT_EQ(read_text(base.path + "/compare.csv"), "mine");
  EXPECT_NE(into(base.path + "/compare.csv/new").find("cannot be written"),
            std::string::npos);
}

TEST(Compare, RefusesWhatCannotBeCompared)
{
  const TemporaryFolder base;
  const std::string     a = make_run(base.path + "/a", "2", some_statistics);
  const std::string     b = make_run(base.path + "/b", "3", some_statistics);
  const std::string     c =
    make_run(base.path + "/c", "2", "step,time (s),dt (s)\n1,1,0.1\n");
  const std::string d =
    make_run(base.path + "/d", "2", "step,time (s)\n1,much\n");
  const auto why = [&](const std::string &other) {
    return refusal([&] { compare_runs(a, other); });
  };
  EXPECT_NE(why(b).find("dimensions differ"), std::string::npos);
  EXPECT_NE(why(c).find("share nothing"), std::string::npos);
  EXPECT_NE(why(d).find("'much'"), std::string::npos);
  EXPECT_NE(why(base.path).find("not the output folder"), std::string::npos);
  write_text(a + "/particles.pvd", "<VTKFile>");
  write_text(c + "/particles.pvd", "<VTKFile>");
  EXPECT_NE(why(c).find("particles.pvd"), std::string::npos);
}
