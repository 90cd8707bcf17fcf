// Finite elements on a mesh that changes: meshes made by chance, so that nodes
// come, go, hang and hang no more.
#include <selkie/adapt/flag_cells.h>
#include <selkie/drivers/stepper.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/output/audit.h>
#include <selkie/transfer/recall_points.h>

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "../small_scenes.h"

namespace
{
  using namespace selkie;
  using dealii::Tensor;

  const std::vector<std::string> elements = {"Approximation=q4 fem",
                                             "Domain/Cells=4, 4",
                                             "Bodies/block/Shape="
                                             "box(0, 0, 1, 1)"};

  const char *const block_3d = R"(
set Title         = block
set Dimension     = 3
set Approximation = q4 fem
set Effects       = inertia
subsection Domain
  set Lower corner = 0, 0, 0
  set Upper corner = 1, 1, 1
  set Cells        = 2, 2, 2
end
subsection Bodies
  set Names = block
  subsection block
    set Law   = neo hookean
    set Shape = box(0, 0, 0, 1, 1, 1)
    subsection Law parameters
      set Density       = 1000
      set Young modulus = 1e6
      set Poisson ratio = 0.3
    end
  end
end
)";

  /// Levels that are wanted by chance, the same ones on any number of ranks.
  template <int dim>
  WantedLevels<dim>
  levels_by_chance(
    const dealii::parallel::distributed::Triangulation<dim> &mesh,
    const unsigned int                                       step,
    const unsigned int                                       finest)
  {
    std::vector<typename WantedLevels<dim>::Part> parts;
    for (const auto &cell : mesh.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const unsigned int level = cell->level();
          std::seed_seq      seed{step,
                             level,
                             unsigned(1e6 * cell->center()[0]),
                             unsigned(1e6 * cell->center()[1]),
                             unsigned(1e6 * cell->center()[dim - 1])};
          std::mt19937       chance(seed);
          const bool         finer = chance() % 3 == 0 && level < finest;
          // Families go together: the parent decides.
          const bool coarser =
            level > 0 &&
            unsigned(1e3 * cell->parent()->center()[0] + step) % 2 == 0;
          parts.push_back({cell->bounding_box(),
                           finer     ? level + 1
                           : coarser ? level - 1
                                     : level});
        }
    return {parts, mesh.get_communicator()};
  }

  template <int dim>
  void
  change_mesh(const Scene<dim>                                  &scene,
              dealii::parallel::distributed::Triangulation<dim> &mesh,
              ParticleSet<dim>                                  &particles,
              CarriedFields<dim>                                &fields,
              const unsigned int                                 step)
  {
    flag_cells<dim>(
      mesh,
      NodeCloud<dim>(mesh),
      levels_by_chance(mesh, step, dim == 2 ? 5 : 3),
      [](const auto &) { return 0u; },
      1000000);
    const auto next = flagged_forest<dim>(mesh, [&](const auto &cell) {
      return particles.weight(cell);
    });
    fields.carry_over(
      [&] { particles.remesh([&] { rebuild(scene.domain, mesh, *next); }); });
    fields.make_continuous();
    recall_points(particles, fields);
  }

  template <int dim>
  Tensor<2, dim>
  some_matrix(const double factor)
  {
    Tensor<2, dim> A;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        A[i][j] = factor * (0.3 * i - 0.2 * j + 0.1 * i * j + 0.05);
    return A;
  }

  /// Affine fields at the nodes are affine at the points of any mesh, and mass
  /// and volume are the same.
  template <int dim>
  void
  keep_affine_fields(const Scene<dim> &scene)
  {
    const auto       mesh = make_background_mesh(scene.domain, MPI_COMM_WORLD);
    ParticleSet<dim> particles(scene, *mesh);
    particles.seed();
    const Audit                                 before   = audit(particles);
    const std::map<std::string, Tensor<2, dim>> matrices = {
      {"displacement", some_matrix<dim>(1.)},
      {"velocity", some_matrix<dim>(2.)},
      {"acceleration", some_matrix<dim>(-3.)}};

    CarriedFields<dim> fields;
    fields.dofs.reinit(*mesh);
    for (const auto &[name, A] : matrices)
      for (unsigned int d = 0; d < dim; ++d)
        fields.values[component_name(name, d)];
    fields.reinit();
    for (const auto &cell : fields.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int v : cell->vertex_indices())
          for (const auto &[name, A] : matrices)
            for (unsigned int d = 0; d < dim; ++d)
              if (const auto dof = cell->vertex_dof_index(v, 0);
                  fields.dofs.locally_owned_dofs().is_element(dof))
                fields.values[component_name(name, d)](dof) =
                  A[d] * Tensor<1, dim>(cell->vertex(v));
    fields.update_ghosts();

    const auto                  &columns = particles.columns;
    std::set<unsigned long long> cells;
    for (unsigned int step = 0; step < (dim == 2 ? 12 : 4); ++step)
      {
        change_mesh(scene, *mesh, particles, fields, step);
        cells.insert(mesh->n_global_active_cells());
        for (const auto &point : particles.handler())
          {
            const auto           mine = point.get_properties();
            const Tensor<1, dim> X    = columns.X(mine);
            const Tensor<2, dim> I    = dealii::unit_symmetric_tensor<dim>();
            const auto          &A    = matrices.at("displacement");
            ASSERT_LT((point.get_location() - X - A * X).norm(), 1e-13);
            ASSERT_LT((columns.F(mine) - I - A).norm(), 1e-12);
            ASSERT_LT((columns.v(mine) - matrices.at("velocity") * X).norm(),
                      1e-13);
            ASSERT_LT(
              (columns.a(mine) - matrices.at("acceleration") * X).norm(),
              1e-13);
          }
        const Audit after = audit(particles);
        ASSERT_NEAR(after.mass, before.mass, 1e-12 * before.mass);
        ASSERT_NEAR(after.volume,
                    before.volume * determinant(Tensor<2, dim>(
                                      dealii::unit_symmetric_tensor<dim>() +
                                      matrices.at("displacement"))),
                    1e-12);
      }
    EXPECT_GT(cells.size(), dim == 2 ? 6u : 2u); // it did change
  }
} // namespace


TEST(AdaptElementsMPI, KeepAffineFields)
{
  keep_affine_fields(
    small_scenes::read<2>(small_scenes::free_block(), elements));
}


TEST(AdaptElementsMPI, KeepAffineFieldsIn3D)
{
  keep_affine_fields(small_scenes::read<3>(block_3d));
}


/// A block almost without stiffness flies with an affine velocity, on another
/// mesh after every step: x = (I + t A) X, v = A X.
TEST(AdaptElementsMPI, FlyAffinely)
{
  auto settings = elements;
  settings.push_back("Bodies/block/Initial velocity="
                     "0.5*x + 0.8*y; -0.3*x - 0.2*y");
  settings.push_back("Bodies/block/Law parameters/Young modulus=1e-12");
  const auto scene =
    small_scenes::read<2>(small_scenes::free_block(), settings);
  const auto     mesh = make_background_mesh(scene.domain, MPI_COMM_WORLD);
  ParticleSet<2> particles(scene, *mesh);
  TimerTree      timers(MPI_COMM_WORLD);
  particles.seed();
  auto       cloud        = std::make_unique<NodeCloud<2>>(*mesh);
  const auto make_stepper = [&] {
    return std::make_unique<Stepper<2>>(
      scene, particles, *cloud, timers, [](const std::string &) {});
  };
  auto         stepper = make_stepper();
  const double dt      = 0.02;
  stepper->start(0., dt);
  Tensor<2, 2> A;
  A[0][0] = 0.5, A[0][1] = 0.8, A[1][0] = -0.3, A[1][1] = -0.2;
  const Audit before = audit(particles);
  for (unsigned int step = 0; step < 10; ++step)
    {
      stepper->step(step * dt, dt);
      CarriedFields<2> fields;
      fields.take(*mesh, cloud->dof_handler(), stepper->kept_fields());
      fields.make_continuous();
      const KeptNumbers numbers = stepper->kept_numbers();
      const CostLedger  costs   = stepper->costs();
      stepper.reset();
      cloud.reset();
      change_mesh(scene, *mesh, particles, fields, step);
      cloud   = std::make_unique<NodeCloud<2>>(*mesh);
      stepper = make_stepper();
      stepper->go_on_from(fields, numbers, costs);

      const Tensor<2, 2> F =
        Tensor<2, 2>(dealii::unit_symmetric_tensor<2>()) + (step + 1) * dt * A;
      for (const auto &point : particles.handler())
        {
          const auto         mine = point.get_properties();
          const Tensor<1, 2> X    = particles.columns.X(mine);
          ASSERT_LT((point.get_location() - F * X).norm(), 1e-10) << step;
          ASSERT_LT((particles.columns.F(mine) - F).norm(), 1e-10) << step;
          ASSERT_LT((particles.columns.v(mine) - A * X).norm(), 1e-9) << step;
        }
      const Audit after = audit(particles);
      EXPECT_NEAR(after.kinetic, before.kinetic, 1e-9 * before.kinetic);
      EXPECT_LT((after.momentum - before.momentum).norm(),
                1e-9 * before.momentum.norm());
    }
}
