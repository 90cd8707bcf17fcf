#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/cell_locator.h>

#include <gtest/gtest.h>

#include <cmath>

#include "../test_shapes.h"

using namespace selkie;
using dealii::Point;


TEST(BackgroundMeshMPI, WallsAreBoundaryIds)
{
  const auto domain = test::graded_domain<3>();
  const auto mesh   = make_background_mesh(domain, MPI_COMM_WORLD);
  for (const auto &cell : mesh->active_cell_iterators())
    if (cell->is_locally_owned())
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary())
          {
            const unsigned int wall = cell->face(f)->boundary_id();
            const double       x    = cell->face(f)->center()[wall / 2];
            EXPECT_NEAR(x,
                        (wall % 2 ? domain.upper : domain.lower)[wall / 2],
                        1e-14);
          }
}

TEST(BackgroundMeshMPI, CellsOfTheSceneWhereNothingIsRefined)
{
  auto domain = test::graded_domain<2>();
  domain.refinements.clear();
  domain.cells    = {{12, 8}};
  const auto mesh = make_background_mesh(domain, MPI_COMM_WORLD);
  EXPECT_EQ(mesh->n_global_active_cells(), 96u);
  EXPECT_EQ(mesh->n_cells(0), 6u); // the rest by refinement
}

TEST(BackgroundMeshMPI, RefinesWhatTouchesAShapeHoweverSmall)
{
  auto domain        = test::graded_domain<2>();
  domain.refinements = {
    {"tiny",
     std::make_shared<test::Box<2>>(Point<2>(.513, .513), Point<2>(.514, .514)),
     3}};
  const auto         mesh   = make_background_mesh(domain, MPI_COMM_WORLD);
  const auto         x      = Point<2>(.5135, .5135);
  const unsigned int finest = 1 + 3; // 10 cells: 5 coarse ones, halved once
  EXPECT_EQ(mesh->n_global_levels(), finest + 1);
  const auto place = CellLocator<2>(*mesh).locate(x);
  if (place.cell->is_locally_owned())
    {
      EXPECT_EQ(place.cell->level(), static_cast<int>(finest));
    }
}

TEST(CellLocatorMPI, FindsTheCellOfItsPoint)
{
  const auto mesh =
    make_background_mesh(test::graded_domain<3>(), MPI_COMM_WORLD);
  const CellLocator<3> locator(*mesh);
  for (const auto &cell : mesh->active_cell_iterators())
    if (!cell->is_artificial())
      {
        const auto place = locator.locate(cell->center());
        EXPECT_EQ(place.cell, cell);
        EXPECT_NEAR(place.reference.distance(Point<3>(.5, .5, .5)), 0, 1e-12);
        for (const unsigned int v : cell->vertex_indices())
          {
            const auto x = cell->vertex(v);
            EXPECT_NEAR(locator.position(locator.key(x)).distance(x), 0, 1e-14);
          }
      }
}
