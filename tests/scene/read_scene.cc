#include <selkie/base/exceptions.h>
#include <selkie/laws/newtonian_fluid.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/read_scene.h>

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace
{
  using namespace selkie;

  const std::string benchmarks =
    std::string(SELKIE_SOURCE_DIR) + "/prm/benchmarks/";


  /// The message with which the dam break is refused when it is changed so.
  std::string
  refusal(const std::vector<std::string> &overrides)
  {
    try
      {
        read_scene<2>(benchmarks + "dam_break_obstacle.prm", overrides);
      }
    catch (const SceneError &error)
      {
        return error.what();
      }
    return "accepted";
  }


  void
  expect_refusal(const std::vector<std::string> &overrides,
                 const std::string              &parameter,
                 const std::string              &why)
  {
    const std::string message = refusal(overrides);
    EXPECT_NE(message.find("dam_break_obstacle.prm"), std::string::npos)
      << message;
    EXPECT_NE(message.find(parameter), std::string::npos) << message;
    EXPECT_NE(message.find(why), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
} // namespace


TEST(ReadScene, DamBreakOnObstacle)
{
  const std::string file = benchmarks + "dam_break_obstacle.prm";
  ASSERT_EQ(read_dimension(file), 2u);
  const Scene<2> scene = read_scene<2>(file);
  EXPECT_EQ(scene.file, file);
  EXPECT_EQ(scene.title, "Dam break on an elastic obstacle");
  EXPECT_EQ(scene.domain.upper[0], 0.584);
  EXPECT_EQ(scene.domain.cells[0], 98u);
  EXPECT_EQ(scene.domain.walls[3].condition, NodeCondition::slip);
  EXPECT_FALSE(scene.domain.walls[3].components[0]);
  EXPECT_TRUE(scene.domain.walls[3].components[1]);

  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(scene.bodies[0].name, "water");
  EXPECT_EQ(scene.bodies[0].phase, 0u);
  EXPECT_EQ(scene.bodies[1].phase, 1u);
  EXPECT_EQ(scene.bodies[1].law->phase(), Phase::solid);
  EXPECT_DOUBLE_EQ(scene.bodies[1].law->density(), 2500.);
  EXPECT_DOUBLE_EQ(scene.bodies[1].shape->volume(), (0.304 - 0.292) * 0.08);
  const auto &water = dynamic_cast<const FluidLaw &>(*scene.bodies[0].law);
  EXPECT_DOUBLE_EQ(water.bulk_modulus(), 2e6);

  ASSERT_EQ(scene.node_sets.size(), 1u);
  EXPECT_TRUE(scene.node_sets[0].components[0]);
  EXPECT_TRUE(scene.node_sets[0].components[1]);
  ASSERT_TRUE(scene.inertia.has_value());
  EXPECT_DOUBLE_EQ(scene.inertia->newmark_beta, 0.3025);
  ASSERT_TRUE(scene.gravity.has_value());
  EXPECT_DOUBLE_EQ((*scene.gravity)[1], -9.81);
  EXPECT_TRUE(scene.has_effect("viscosity"));
  EXPECT_TRUE(scene.has_fluid());
  EXPECT_EQ(scene.transfer.flip_fraction, 0.98);
  EXPECT_EQ(scene.leaving, LeavingPolicy::keep);
  ASSERT_EQ(scene.probes.size(), 3u);
  EXPECT_EQ(scene.probes[1].kind, Probe<2>::Kind::front);
  EXPECT_EQ(scene.output.directory, "output/dam_break_obstacle");
}


TEST(ReadScene, BenchmarksAreValid)
{
  for (const std::string name : {"vibrating_bar",
                                 "cantilever",
                                 "hydrostatic_column",
                                 "elliptical_drop",
                                 "dam_break",
                                 "dam_break_obstacle",
                                 "hydrostatic_plate"})
    EXPECT_NO_THROW(read_scene<2>(benchmarks + name + ".prm")) << name;
  for (const std::string name : {"vibrating_bar_3d", "elliptical_drop_3d"})
    {
      EXPECT_EQ(read_dimension(benchmarks + name + ".prm"), 3u);
      EXPECT_NO_THROW(read_scene<3>(benchmarks + name + ".prm")) << name;
    }
}


TEST(ReadScene, OverridesAreStrongerThanTheFile)
{
  const auto scene =
    read_scene<2>(benchmarks + "dam_break_obstacle.prm",
                  {"Bodies/obstacle/Law parameters/Density=1100",
                   "Time/Step = 2e-3",
                   "Output/Directory=elsewhere"});
  EXPECT_DOUBLE_EQ(scene.bodies[1].law->density(), 1100.);
  EXPECT_DOUBLE_EQ(scene.time.step, 2e-3);
  EXPECT_EQ(scene.output.directory, "elsewhere");
  EXPECT_EQ(scene.parameters.at("Time/Step").value, "2e-3");
}


// What is absent costs nothing: it is not in the scene at all.
TEST(ReadScene, AbsentEffectsAreAbsent)
{
  const auto scene = read_scene<2>(benchmarks + "vibrating_bar.prm");
  EXPECT_FALSE(scene.gravity.has_value());
  EXPECT_FALSE(scene.has_effect("viscosity"));
  EXPECT_FALSE(scene.has_fluid());
  EXPECT_EQ(scene.effect_names(),
            (std::vector<std::string>{
              "inertia", "elasticity", "wall contact", "probes", "audit"}));
  EXPECT_TRUE(scene.tractions.empty());
  EXPECT_EQ(scene.parameters.count("Gravity/Acceleration"), 0u);
  EXPECT_EQ(scene.parameters.count("Fluid pressure/Stabilisation"), 0u);
}


TEST(ReadScene, ResolvedParametersReadBackAsTheSameScene)
{
  const auto scene =
    read_scene<2>(benchmarks + "hydrostatic_plate.prm",
                  {"Domain/Refinements/Names=plate",
                   "Domain/Refinements/plate/Shape=box(0, 0, 1, 0.1)",
                   "Domain/Refinements/plate/Levels=2"});
  const std::string file = "read_scene_resolved.prm";
  std::ofstream(file) << scene.resolved;
  const auto again = read_scene<2>(file);
  std::remove(file.c_str());
  ASSERT_EQ(again.parameters.size(), scene.parameters.size());
  for (const auto &[path, parameter] : scene.parameters)
    EXPECT_EQ(again.parameters.at(path).value, parameter.value) << path;
  ASSERT_EQ(again.domain.refinements.size(), 1u);
  EXPECT_EQ(again.domain.refinements[0].levels, 2u);
  EXPECT_EQ(again.effect_names(), scene.effect_names());
}


TEST(ReadScene, PrescribedMotionWithAFreeComponent)
{
  const std::string effects =
    "Effects=inertia, gravity, viscosity, probes, prescribed motion";
  const auto scene =
    read_scene<2>(benchmarks + "dam_break_obstacle.prm",
                  {effects,
                   "Domain/Walls/left=prescribed",
                   "Domain/Walls/left velocity=0.1*cos(t); free"});
  const auto &wall = scene.domain.walls[0];
  EXPECT_TRUE(wall.components[0]);
  EXPECT_FALSE(wall.components[1]);
  EXPECT_DOUBLE_EQ(wall.velocity->value(dealii::Point<2>(), 0.)[0], 0.1);
  expect_refusal({effects, "Domain/Walls/left=prescribed"},
                 "Domain/Walls/left velocity",
                 "needs a velocity");
  expect_refusal({effects}, "Effects", "no wall is 'prescribed'");
  expect_refusal({"Domain/Walls/left=prescribed",
                  "Domain/Walls/left velocity=1; 0"},
                 "Domain/Walls/left velocity",
                 "effect 'prescribed motion'");
}


TEST(ReadScene, TractionAndBodyForce)
{
  const std::string              file = benchmarks + "cantilever.prm";
  const std::vector<std::string> base = {
    "Effects=inertia, gravity, probes, traction, body force",
    "Tractions/Names=pull",
    "Tractions/pull/Face=right",
    "Tractions/pull/Value=0; 1e3*t",
    "Body force/Acceleration=X; 0"};
  const auto scene = read_scene<2>(file, base);
  ASSERT_EQ(scene.tractions.size(), 1u);
  EXPECT_EQ(scene.tractions[0].face, 1u);
  EXPECT_EQ(scene.tractions[0].body, 0u);
  const dealii::Point<2> p(2., 0.);
  EXPECT_DOUBLE_EQ(scene.tractions[0].value->value(p, 2.)[1], 2e3);
  EXPECT_TRUE(scene.has_effect("body force"));

  auto no_box = base;
  no_box.push_back("Bodies/beam/Shape=box(0, 0, 4, 1) - disc(2, 0.5, 0.2)");
  EXPECT_THROW(read_scene<2>(file, no_box), SceneError);
  auto no_value = base;
  no_value.push_back("Tractions/pull/Value=");
  EXPECT_THROW(read_scene<2>(file, no_value), SceneError);
  auto no_such_body = base;
  no_such_body.push_back("Tractions/pull/Body=rope");
  EXPECT_THROW(read_scene<2>(file, no_such_body), SceneError);
}


TEST(ReadScene, Refusals)
{
  expect_refusal({"Time/Stepp=1"}, "Time/Stepp", "Allowed here are: End time");
  expect_refusal({"Tim/Step=1"}, "Tim/Step", "no subsection 'Tim'");
  expect_refusal({"Time/Step=fast"}, "'Time/Step' = 'fast'", "a number");
  expect_refusal({"Domain/Cells=98"}, "Domain/Cells", "2 values");
  expect_refusal({"Transfer/Scheme=apic"}, "'apic'", "one of: flip, tpic");
  expect_refusal({"Time/Step=0"}, "Time/Step", "positive");
  expect_refusal({"Domain/Cells=98, 37"}, "Domain/Cells", "squares");
  expect_refusal({"Bodies/Names=water, water"}, "Bodies/Names", "twice");
  expect_refusal({"Bodies/water/Law=honey"}, "Bodies/water/Law", "neo hookean");
  expect_refusal({"Effects=inertia, magic"}, "Effects", "no effect 'magic'");
  expect_refusal({"Effects=inertia, gravity, viscosity"},
                 "Probes/Names",
                 "belongs to the effect 'probes'");
  expect_refusal({"Effects=inertia, gravity, probes"},
                 "Bodies/water/Law parameters/Viscosity",
                 "belongs to the effect 'viscosity'");
  expect_refusal({"Gravity/Acceleration=0, 0"}, "Gravity", "zero");
  expect_refusal({"Bodies/water/Law parameters/Viscosity=0"},
                 "Effects",
                 "every fluid 0: it would do nothing and cost");
  expect_refusal({"Effects=inertia, gravity, viscosity, probes, elasticity"},
                 "Effects",
                 "comes by itself");
  expect_refusal({"Bodies/water/Points per direction=0"},
                 "Points per direction",
                 "from 1 to 20");
  expect_refusal({"Bodies/water/Shape=box(0, 0, 0.001, 0.001)"},
                 "Bodies/water/Shape",
                 "no material point");
  expect_refusal({"Bodies/water/Shape=box(0, 0, 1)"},
                 "Bodies/water/Shape",
                 "needs 4 arguments");
  expect_refusal({"Bodies/water/Initial velocity=1"},
                 "Initial velocity",
                 "1 components");
  expect_refusal({"Node sets/foot/Shape=box(0.293, 0, 0.294, 0.001)"},
                 "Node sets/foot/Shape",
                 "no node");
  expect_refusal({"Node sets/foot/Components=x, w"}, "Components", "x, y");
  expect_refusal({"Probes/front/Body=wine"}, "Probes/front/Body", "obstacle");
  expect_refusal({"Inertia/Newmark beta=0.2"}, "Newmark beta", "unstable");
  expect_refusal({"LME/Gamma=6"}, "LME/Gamma", "too few nodes");
  expect_refusal({"Title"}, "Title", "Name=value");
}


TEST(ReadScene, AtMost31SolidBodies)
{
  Scene<2> scene             = read_scene<2>(benchmarks + "vibrating_bar.prm");
  scene.bodies.front().phase = 32;
  EXPECT_THROW(check_scene(scene), SceneError);
}
