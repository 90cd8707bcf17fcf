#include <selkie/particles/fields.h>

#include <gtest/gtest.h>

#include <vector>

using dealii::Tensor;
using selkie::Column;
using selkie::ParticleFields;


TEST(ParticleFields, ColumnsFollowEachOther)
{
  ParticleFields fields;
  const auto     mass = fields.add<double>("mass", "kg", true);
  const auto     F    = fields.add<Tensor<2, 3>>("F", "");
  const auto     v    = fields.add<Tensor<1, 3>>("velocity", "m/s");
  EXPECT_EQ(mass.offset, 0u);
  EXPECT_EQ(F.offset, 1u);
  EXPECT_EQ(v.offset, 10u);
  EXPECT_EQ(fields.n_components(), 13u);
  ASSERT_EQ(fields.entries().size(), 3u);
  EXPECT_EQ(fields.entries()[1].name, "F");
  EXPECT_EQ(fields.entries()[1].n_components, 9u);
  EXPECT_TRUE(fields.entries()[0].output);
  EXPECT_FALSE(fields.entries()[1].output);
}

TEST(ParticleFields, SecondRequestGetsTheSameColumn)
{
  ParticleFields fields;
  const auto     first  = fields.add<Tensor<1, 2>>("velocity", "m/s");
  const auto     second = fields.add<Tensor<1, 2>>("velocity", "m/s", true);
  EXPECT_EQ(first.offset, second.offset);
  EXPECT_EQ(fields.n_components(), 2u);
  EXPECT_TRUE(fields.entries()[0].output);
  EXPECT_ANY_THROW(fields.add<double>("velocity", "m/s"));
}

TEST(ParticleFields, ValuesComeBack)
{
  ParticleFields      fields;
  const auto          mass = fields.add<double>("mass", "kg");
  const auto          F    = fields.add<Tensor<2, 2>>("F", "");
  std::vector<double> properties(fields.n_components(), -1.);
  Tensor<2, 2>        value;
  value[0][1] = 1.;
  value[1][0] = 2.;
  mass.set(dealii::make_array_view(properties), 3.);
  F.set(dealii::make_array_view(properties), value);
  EXPECT_EQ(properties, std::vector<double>({3., 0., 1., 2., 0.}));
  EXPECT_EQ(mass(dealii::make_array_view(properties)), 3.);
  EXPECT_EQ(F(dealii::make_array_view(properties)), value);
}

TEST(ParticleFields, AbsentColumnDoesNotExist)
{
  EXPECT_FALSE(Column<double>().exists());
  EXPECT_TRUE(Column<double>(0).exists());
}
