// read_json of this Boost uses its own deprecated placeholders
#define BOOST_BIND_GLOBAL_PLACEHOLDERS

#include <selkie/base/exceptions.h>
#include <selkie/laws/hyperelastic_law.h>
#include <selkie/laws/law_table.h>
#include <selkie/laws/newtonian_fluid.h>

#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/ptree.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

using namespace selkie;

namespace
{
  /// The message of the SceneError that the law @p name throws when
  /// @p parameter has @p value; empty if it throws none.
  std::string
  refusal(const std::string &name,
          const std::string &parameter,
          const std::string &value)
  {
    dealii::ParameterHandler prm;
    prm.enter_subsection("Body");
    const LawRow *row = find_law(name);
    row->declare(prm);
    prm.set(parameter, value);
    try
      {
        row->create(prm);
      }
    catch (const SceneError &error)
      {
        return error.what();
      }
    return "";
  }
} // namespace


TEST(LawsTable, EveryRowIsComplete)
{
  for (const LawRow &row : law_table())
    {
      EXPECT_EQ(find_law(row.name), &row);
      EXPECT_FALSE(row.documentation.empty());

      dealii::ParameterHandler prm;
      row.declare(prm);
      const std::unique_ptr<const Law> law = row.create(prm);
      EXPECT_DOUBLE_EQ(law->density(), 1000.);
      EXPECT_GT(law->sound_speed(), 0.);
      if (law->phase() == Phase::solid)
        EXPECT_NE(dynamic_cast<const HyperelasticLaw *>(law.get()), nullptr);
      else
        EXPECT_NE(dynamic_cast<const FluidLaw *>(law.get()), nullptr);
    }
  EXPECT_EQ(find_law("aether"), nullptr);
  EXPECT_EQ(law_names().find("neo hookean|isochoric neo hookean|"), 0u);
}


TEST(LawsTable, EveryParameterHasItsUnit)
{
  for (const LawRow &row : law_table())
    {
      dealii::ParameterHandler prm;
      row.declare(prm);
      std::stringstream text;
      prm.print_parameters(text, dealii::ParameterHandler::JSON);
      boost::property_tree::ptree tree;
      boost::property_tree::read_json(text, tree);
      EXPECT_GE(tree.size(), 3u);
      for (const auto &entry : tree)
        {
          const auto documentation =
            entry.second.get<std::string>("documentation");
          EXPECT_NE(documentation.find(" Units: "), std::string::npos)
            << row.name << ": " << entry.first << ": " << documentation;
          EXPECT_EQ(documentation.back(), '.');
        }
    }
}


TEST(LawsTable, ValuesAreReadFromTheCurrentSubsection)
{
  dealii::ParameterHandler prm;
  prm.enter_subsection("Water");
  const LawRow *row = find_law("newtonian fluid");
  row->declare(prm);
  prm.set("Density", 900.);
  prm.set("Bulk modulus", 3.6e5);
  prm.set("Pressure exponent", 5.);
  prm.set("Reference pressure", 7.);
  prm.set("Viscosity", 0.25);
  const auto  law   = row->create(prm);
  const auto &fluid = dynamic_cast<const FluidLaw &>(*law);
  EXPECT_DOUBLE_EQ(fluid.density(), 900.);
  EXPECT_DOUBLE_EQ(fluid.sound_speed(), 20.);
  EXPECT_DOUBLE_EQ(fluid.bulk_modulus(), 3.6e5);
  EXPECT_DOUBLE_EQ(fluid.viscosity(0.).value, 0.25);
  EXPECT_DOUBLE_EQ(fluid.pressure(1.), 7.);
  EXPECT_DOUBLE_EQ(fluid.pressure(0.5), 7. + 3.6e5 / 5. * 31.);
}


TEST(LawsTable, BadValuesAreRefusedByName)
{
  EXPECT_EQ(refusal("neo hookean", "Poisson ratio", "0.5"),
            "the parameter 'Poisson ratio' is 0.5; it must be at least 0 and "
            "less than 0.5");
  for (const LawRow &row : law_table())
    EXPECT_EQ(refusal(row.name, "Density", "0"),
              "the parameter 'Density' is 0; it must be positive and finite");
  EXPECT_NE(refusal("saint venant kirchhoff", "Young modulus", "0"), "");
  EXPECT_NE(refusal("mooney rivlin", "Mooney C10", "0"), "");
  EXPECT_NE(refusal("mooney rivlin", "Bulk modulus", "2e5"), "");
  EXPECT_NE(refusal("newtonian fluid", "Bulk modulus", "0"), "");
  EXPECT_NE(refusal("newtonian fluid", "Pressure exponent", "1"), "");
  EXPECT_EQ(refusal("newtonian fluid", "Viscosity", "0"), "");
  EXPECT_THROW(NewtonianFluid(1., 7., 0., -1e-3, 1.), SceneError);
  EXPECT_THROW(lame_constants(1., -0.1), SceneError);
  EXPECT_THROW(lame_constants(std::nan(""), 0.1), SceneError);
}
