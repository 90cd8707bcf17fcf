#include <selkie/base/exceptions.h>
#include <selkie/scene/shapes.h>

#include <deal.II/base/numbers.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace
{
  using namespace selkie;
  using dealii::Point;
  using dealii::numbers::PI;

  template <int dim>
  double
  volume(const std::string &text)
  {
    return make_shape<dim>(text)->volume();
  }


  /// The message with which a text is refused.
  template <int dim>
  std::string
  refusal(const std::string &text)
  {
    try
      {
        make_shape<dim>(text);
      }
    catch (const SceneError &error)
      {
        return error.what();
      }
    return "accepted";
  }


  bool
  has(const std::string &text, const std::string &part)
  {
    return text.find(part) != std::string::npos;
  }
} // namespace


TEST(Shapes, PrimitivesHaveExactVolumes)
{
  EXPECT_DOUBLE_EQ(volume<2>("box(0, 0, 0.146, 2*0.146)"), 0.146 * 0.292);
  EXPECT_DOUBLE_EQ(volume<3>("box(-1, 0, 0, 1, 2, 0.5)"), 2.);
  EXPECT_DOUBLE_EQ(volume<2>("disc(0.5, 0.5, 0.2)"), PI * 0.04);
  EXPECT_DOUBLE_EQ(volume<3>("sphere(1, 2, 3, 2)"), 32. / 3. * PI);
  EXPECT_DOUBLE_EQ(volume<2>("polygon(0, 0, 2, 0, 2, 1, 1, 1, 1, 3, 0, 3)"),
                   4.);
  // Clockwise is as good.
  EXPECT_DOUBLE_EQ(volume<2>("polygon(0, 0, 0, 1, 1, 0)"), 0.5);
}


TEST(Shapes, BoundaryIsInside)
{
  const auto box = make_shape<2>("box(0.1, 0.2, 0.3, 0.4)");
  EXPECT_TRUE(box->contains(Point<2>(0.1, 0.4)));
  EXPECT_TRUE(box->contains(Point<2>(3 * 0.1, 0.3))); // 0.30000000000000004
  EXPECT_FALSE(box->contains(Point<2>(0.3 + 1e-9, 0.3)));
  const auto disc = make_shape<2>("disc(1, 1, 0.1)");
  EXPECT_TRUE(disc->contains(Point<2>(1.1, 1)));
  EXPECT_FALSE(disc->contains(Point<2>(1.1, 1.001)));
  const auto triangle = make_shape<2>("polygon(0, 0, 1, 0, 0, 1)");
  EXPECT_TRUE(triangle->contains(Point<2>(0.5, 0.5)));
  EXPECT_TRUE(triangle->contains(Point<2>(1, 0)));
  EXPECT_TRUE(triangle->contains(Point<2>(0.2, 0.2)));
  EXPECT_FALSE(triangle->contains(Point<2>(0.501, 0.501)));
}


TEST(Shapes, UnionsAndDifferences)
{
  // Disjoint, though the bounding boxes overlap: exact.
  EXPECT_DOUBLE_EQ(volume<2>("disc(0, 0, 1) + disc(1.8, 1.8, 1)"), 2 * PI);
  // Boxes that share a side.
  EXPECT_DOUBLE_EQ(volume<2>("box(0, 0, 1, 1) + box(1, 0, 2, 1)"), 2.);
  // Boxes that overlap.
  EXPECT_DOUBLE_EQ(volume<2>("box(0, 0, 1, 1) + box(0.5, 0.5, 2, 2)"), 3.);
  // A hole inside, one that sticks out, from left to right, parentheses.
  EXPECT_DOUBLE_EQ(volume<2>("box(0, 0, 1, 1) - disc(0.5, 0.5, 0.2)"),
                   1 - 0.04 * PI);
  EXPECT_DOUBLE_EQ(volume<2>("box(0, 0, 1, 1) - box(0.5, 0, 2, 1)"), 0.5);
  EXPECT_DOUBLE_EQ(volume<2>("box(0,0,1,1) - box(0,0,1,0.5) + box(0,0,1,0.25)"),
                   0.75);
  EXPECT_DOUBLE_EQ(
    volume<2>("box(0,0,1,1) - (box(0,0,1,0.5) + box(0,0.75,1,1))"), 0.25);
  EXPECT_DOUBLE_EQ(volume<3>("box(0,0,0,1,1,1) - sphere(.5,.5,.5,.5)"),
                   1 - PI / 6);
  // Neither: by sampling.
  EXPECT_NEAR(volume<2>("box(0, 0, 1, 1) - disc(0, 0, 1)"), 1 - PI / 4, 1e-3);

  const auto ring = make_shape<2>("disc(0, 0, 1) - disc(0, 0, 0.5)");
  EXPECT_FALSE(ring->contains(Point<2>(0.1, 0.1)));
  EXPECT_TRUE(ring->contains(Point<2>(0.7, 0.)));
  EXPECT_TRUE(ring->contains(Point<2>(0.5, 0.)));
  EXPECT_DOUBLE_EQ(ring->bounding_box().side_length(0), 2.);
}


TEST(Shapes, InsideAnExpression)
{
  const auto wave =
    make_shape<2>("inside(0, 0, 2, 1, max(0.5, 0) + 0.1*cos(pi*x) - y)");
  EXPECT_TRUE(wave->contains(Point<2>(0, 0.59)));
  EXPECT_FALSE(wave->contains(Point<2>(0, 0.61)));
  EXPECT_FALSE(wave->contains(Point<2>(2.1, 0.1)));
  EXPECT_NEAR(wave->volume(), 1., 1e-3);
}


TEST(Shapes, RefusalsSayWhatIsWrong)
{
  EXPECT_TRUE(has(refusal<2>("cube(0, 0, 1)"), "no such shape in 2D"));
  EXPECT_TRUE(has(refusal<3>("disc(0, 0, 1)"), "no such shape in 3D"));
  EXPECT_TRUE(has(refusal<2>("box(0, 0, 1)"), "needs 4 arguments and has 3"));
  EXPECT_TRUE(has(refusal<2>("box(0, 0, 1, 1"), "a ')' is missing"));
  EXPECT_TRUE(has(refusal<2>("box(0, 0, 1, 1) box(1, 1, 2, 2)"), "left over"));
  EXPECT_TRUE(has(refusal<2>("box(0, 0, 1, x)"), "'x' is not a number"));
  EXPECT_TRUE(has(refusal<2>("box(0, 0, 1, one)"), "cannot be evaluated"));
  EXPECT_TRUE(has(refusal<2>("box(0, 0, -1, 1)"), "no volume"));
  EXPECT_TRUE(has(refusal<2>("disc(0, 0, 0)"), "radius must be positive"));
  EXPECT_TRUE(has(refusal<2>("polygon(0, 0, 1, 1, 0, 1, 1, 0)"), "cross"));
  EXPECT_TRUE(has(refusal<2>("polygon(0, 0, 1, 1, 2, 2)"), "no area"));
  EXPECT_TRUE(has(refusal<2>(""), "name of a shape is missing"));
}
