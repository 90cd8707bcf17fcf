// What nodes know while the mesh is made anew: cells halved and joined, and
// shared out among the ranks in another way.
#include <selkie/adapt/flag_cells.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/forest.h>
#include <selkie/transfer/carried_fields.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "../small_scenes.h"

namespace
{
  using namespace selkie;
  using dealii::Point;

  constexpr double       none     = std::numeric_limits<double>::quiet_NaN();
  constexpr unsigned int n_layers = 2;

  using Mesh   = dealii::parallel::distributed::Triangulation<2>;
  using Vertex = std::array<long, 2>;
  /// The values of both layers at all vertices, in units of 1/64.
  using Values = std::map<Vertex, std::array<double, n_layers>>;

  /// Calls action(vertex, layer, dof) for the vertices of this rank's cells.
  template <typename Action>
  void
  for_each_vertex(const CarriedFields<2> &fields, const Action &action)
  {
    std::vector<dealii::types::global_dof_index> indices(
      fields.dofs.get_fe().n_dofs_per_cell());
    for (const auto &cell : fields.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(indices);
          for (const unsigned int v : cell->vertex_indices())
            for (unsigned int layer = 0; layer < n_layers; ++layer)
              action(Vertex{{std::lround(64. * cell->vertex(v)[0]),
                             std::lround(64. * cell->vertex(v)[1])}},
                     layer,
                     indices[v * n_layers + layer]);
        }
  }

  Values
  gather(const CarriedFields<2> &fields)
  {
    Values mine, all;
    for_each_vertex(fields,
                    [&](const Vertex &x, const unsigned int layer, auto dof) {
                      mine[x][layer] = fields.values.at("some")(dof);
                    });
    for (const auto &part :
         dealii::Utilities::MPI::all_gather(fields.dofs.get_communicator(),
                                            mine))
      all.insert(part.begin(), part.end());
    return all;
  }

  /// One level up around a place that wanders, one down elsewhere.
  void
  flag(Mesh &mesh, const unsigned int step)
  {
    std::vector<WantedLevels<2>::Part> parts;
    const Point<2>                     place(std::fmod(0.3 + 0.23 * step, 1.),
                         std::fmod(0.1 + 0.31 * step, 1.));
    for (const auto &cell : mesh.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const bool near = cell->center().distance(place) < 0.3;
          parts.push_back(
            {cell->bounding_box(),
             near ? std::min(cell->level() + 1u, 5u) : cell->level() - 1u});
        }
    flag_cells<2>(
      mesh,
      NodeCloud<2>(mesh),
      {parts, mesh.get_communicator()},
      [](const auto &) { return 1u; },
      10000);
  }

  /// Whether two numbers are the same, or no numbers both.
  bool
  are_same(const double a, const double b)
  {
    return a == b || (std::isnan(a) && std::isnan(b));
  }

  /// The mean of two vertices that are as far from one between them, in some
  /// direction or diagonal, as a cell is wide that was halved there.
  bool
  is_mean_of_some(const Values      &before,
                  const Vertex      &x,
                  const unsigned int layer,
                  const double       value)
  {
    for (const Vertex &d : {Vertex{{1, 0}}, Vertex{{0, 1}}, Vertex{{1, 1}}})
      for (long h = 1; h <= 16; h *= 2)
        {
          const auto at = [&](const long s, const long t) {
            return before.find({{x[0] + s * h * d[0], x[1] + t * h * d[1]}});
          };
          const auto a = at(-1, -1), b = at(1, 1), c = at(-1, 1), e = at(1, -1);
          const auto end = before.end();
          if (a == end || b == end || c == end || e == end)
            continue;
          const double mean = 0.25 * (a->second[layer] + b->second[layer] +
                                      c->second[layer] + e->second[layer]);
          if (are_same(mean, value) || std::abs(mean - value) < 1e-14)
            return true;
        }
    return false;
  }
} // namespace


/// A node that was there keeps its value to the last bit, a new one has the
/// mean of the corners around it, and none where one of these has none.
TEST(VertexValuesMPI, FollowTheMesh)
{
  const auto scene =
    small_scenes::read<2>(small_scenes::free_block(), {"Domain/Cells=8, 8"});
  const auto mesh = make_background_mesh(scene.domain, MPI_COMM_WORLD);

  CarriedFields<2> fields;
  fields.dofs.reinit(*mesh);
  fields.n_layers = n_layers;
  fields.values["some"];
  fields.values["other"];
  fields.reinit();
  for_each_vertex(fields,
                  [&](const Vertex &x, const unsigned int layer, auto dof) {
                    if (fields.dofs.locally_owned_dofs().is_element(dof))
                      fields.values["some"](dof) =
                        x[0] > 50 ? none
                                  : std::sin(0.1 * x[0]) + 0.01 * x[1] + layer;
                  });
  fields.update_ghosts();

  unsigned int kept = 0, made = 0, without = 0;
  for (unsigned int step = 0; step < 8; ++step)
    {
      const Values before = gather(fields);
      flag(*mesh, step);
      const auto next = flagged_forest<2>(*mesh, [&](const auto &cell) {
        return cell->center()[0] < 0.1 * step ? 7 : 1; // other partitions
      });
      fields.carry_over([&] { rebuild(scene.domain, *mesh, *next); });
      for (const auto &[x, values] : gather(fields))
        for (unsigned int layer = 0; layer < n_layers; ++layer)
          if (const auto old = before.find(x); old != before.end())
            {
              ASSERT_TRUE(are_same(old->second[layer], values[layer]));
              ++kept;
            }
          else
            {
              ASSERT_TRUE(is_mean_of_some(before, x, layer, values[layer]))
                << x[0] << ' ' << x[1];
              ++made;
              without += std::isnan(values[layer]);
            }
    }
  EXPECT_GT(kept, 500u);
  EXPECT_GT(made, 100u);
  EXPECT_GT(without, 10u);
  EXPECT_LT(without, made);
}
