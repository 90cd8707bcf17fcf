// Pairs of nodes between two blocks: where, how far apart, which way.
#include <selkie/mesh/background_mesh.h>
#include <selkie/shape/contact_pairs.h>
#include <selkie/shape/lme_support.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include "../small_scenes.h"

namespace
{
  using namespace selkie;

  /// The pairs of a scene of two blocks (10 cells, faces across y at 0.5 and
  /// 0.5 + gap, above each other for x in 0.4 to 0.7).
  struct Pairs
  {
    /// @param overlap how far the upper block's points then move down (m)
    explicit Pairs(const double gap, const double overlap = 0.)
      : scene(small_scenes::read<2>(small_scenes::two_blocks(gap)))
      , mesh(make_background_mesh(scene.domain, MPI_COMM_WORLD))
      , particles(scene, *mesh)
    {
      particles.seed();
      cloud                = std::make_unique<NodeCloud<2>>(*mesh,
                                             scene.lme.gamma,
                                             scene.lme.support_tolerance,
                                             scene.n_layers());
      const auto occupancy = find_occupancy(particles, *cloud, false);
      fill_material_points(particles, *cloud, occupancy, table);
      for (auto &point : table.points)
        point.x[1] -= point.body == 1 ? overlap : 0.;
      add_contact_pairs(*cloud, occupancy, table);
    }

    /// Calls see(patch, its point) for each.
    template <typename See>
    void
    for_each(const See &see) const
    {
      for (const auto &patch : table.patches)
        if (patch.contact)
          see(patch, table.points[patch.first_point]);
    }

    unsigned int
    size() const
    {
      unsigned int n = 0;
      for_each([&](const auto &, const auto &) { ++n; });
      return dealii::Utilities::MPI::sum(n, MPI_COMM_WORLD);
    }

    Scene<2>                                                         scene;
    std::unique_ptr<dealii::parallel::distributed::Triangulation<2>> mesh;
    ParticleSet<2>                                                   particles;
    std::unique_ptr<NodeCloud<2>>                                    cloud;
    SupportTable<2>                                                  table;
  };
} // namespace

TEST(ContactPairsMPI, NoneBetweenBodiesFarApart)
{
  EXPECT_EQ(Pairs(0.21).size(), 0u);
}

TEST(ContactPairsMPI, GapAndNormalBetweenParallelFaces)
{
  // The lower block's points stand 0.025 below its face at 0.5, whose nodes it
  // shares with an upper block in the cells above.
  for (const double gap : {0., 0.05})
    {
      const Pairs  pairs(gap);
      unsigned int n = 0;
      pairs.for_each([&](const Patch<2> &patch, const StepPoint<2> &point) {
        const unsigned int a = pairs.table.nodes[patch.first_node],
                           b = pairs.table.nodes[patch.first_node + 1];
        EXPECT_EQ(pairs.cloud->layer(a), 0u);
        EXPECT_EQ(pairs.cloud->in_layer(a, 1), b);
        EXPECT_NEAR(point.x[1], 0.5, 1e-12);
        EXPECT_EQ(pairs.table.N(patch, 0)[0], 1.);
        EXPECT_EQ(pairs.table.N(patch, 0)[1], -1.);
        EXPECT_GT(point.mass, 0.);
        const double *n_x = pairs.table.gradient(patch, 0, 0);
        const double *n_y = pairs.table.gradient(patch, 0, 1);
        EXPECT_EQ(n_y[1], -n_y[0]);
        EXPECT_NEAR(n_x[0] * n_x[0] + n_y[0] * n_y[0], 1., 1e-12);
        // In the middle of the common face, away from the corners.
        if (point.x[0] > 0.49 && point.x[0] < 0.61)
          {
            ++n;
            EXPECT_NEAR(n_x[0], 0., 0.15);
            EXPECT_GT(n_y[0], 0.98);
            // A point that is not straight ahead seems farther or nearer by
            // the sine of the normal's error.
            EXPECT_NEAR(point.area, gap, 0.02);
          }
      });
      EXPECT_EQ(dealii::Utilities::MPI::sum(n, MPI_COMM_WORLD), 2u);
    }
}

TEST(ContactPairsMPI, OverlapIsANegativeGap)
{
  const Pairs  pairs(0., 0.03);
  unsigned int n = 0;
  pairs.for_each([&](const auto &, const StepPoint<2> &point) {
    if (point.x[0] > 0.49 && point.x[0] < 0.61)
      {
        ++n;
        EXPECT_NEAR(point.area, -0.03, 0.02);
      }
  });
  EXPECT_EQ(dealii::Utilities::MPI::sum(n, MPI_COMM_WORLD), 2u);
}
