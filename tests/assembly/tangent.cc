// Every block of the assembled tangent against central differences of the
// assembled residual, in a scene with all of them: a viscous mixed fluid with
// PPP, Gauss points in full cells and an elastic solid that shares its nodes.
#include <deal.II/lac/full_matrix.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "../performance/assembled_scene.h"

namespace
{
  using namespace selkie;

  /// A state away from rest, with pressure.
  template <int dim>
  struct Problem : AssembledScene<dim>
  {
    explicit Problem(const std::string              &text,
                     const std::vector<std::string> &overrides = {})
      : AssembledScene<dim>(text, overrides, {0.3025, 0.6, 2e-3})
    {
      const System<dim> &system = *this->system;
      for (unsigned int i = 0; i < system.n_owned(); ++i)
        this->fields.x.local_element(i) =
          i < system.n_owned_displacements()
            ? (system.held(i) ? 0. : 2e-3 * std::sin(3. + i))
            : 500. + 300. * std::sin(i);
    }
  };

  /// Largest error of K d against (R(x + s d) - R(x - s d)) / 2 s, relative to
  /// the largest entry, separately for displacement and pressure rows, for a
  /// direction d in the displacements or in the pressures.
  template <int dim>
  void
  check_direction(Problem<dim> &problem, const bool pressures)
  {
    auto  &system = *problem.system;
    Vector direction, Kd, plus, minus;
    for (Vector *vector : {&direction, &Kd, &plus, &minus})
      system.initialize(*vector);
    const unsigned int n_u = system.n_owned_displacements();
    for (unsigned int i = 0; i < system.n_owned(); ++i)
      if (!system.held(i) && (i >= n_u) == pressures)
        direction.local_element(i) = std::cos(5. * i);

    const double unit = 1.; // pressures in Pa
    problem.assembler->assemble(
      problem.table, problem.time, problem.fields, unit, true, plus);
    system.matrix().vmult(Kd, direction);

    const double step = pressures ? 1. : 1e-7;
    const Vector x    = problem.fields.x;
    const auto   at   = [&](const double s, Vector &residual) {
      problem.fields.x.zero_out_ghost_values();
      problem.fields.x.copy_locally_owned_data_from(x);
      problem.fields.x.add(s, direction);
      problem.assembler->assemble(
        problem.table, problem.time, problem.fields, unit, false, residual);
    };
    at(step, plus);
    at(-step, minus);
    double largest[2] = {0, 0}, error[2] = {0, 0};
    for (unsigned int i = 0; i < system.n_owned(); ++i)
      if (!system.held(i))
        {
          const double difference =
            (plus.local_element(i) - minus.local_element(i)) / (2. * step);
          auto &l = largest[i >= n_u], &e = error[i >= n_u];
          l = std::max(l, std::abs(difference));
          e = std::max(e, std::abs(difference - Kd.local_element(i)));
        }
    EXPECT_LT(error[0], 1e-7 * largest[0]) << "displacement rows";
    if (problem.scene.has_pressure())
      {
        EXPECT_LT(error[1], 1e-7 * largest[1]) << "pressure rows";
      }
  }
} // namespace

TEST(Tangent, DisplacementColumnsOfFluidAndSolid)
{
  Problem<2> problem(small_scenes::fluid_on_solid());
  check_direction(problem, false);
}

TEST(Tangent, ViscosityThatDependsOnTheRateOfShear)
{
  std::string text = small_scenes::fluid_on_solid();
  text.replace(text.find("newtonian fluid"), 15, "bingham fluid");
  text.replace(text.find("set Viscosity    = 5"),
               20,
               "set Plastic viscosity = 5\n set Yield stress = 50\n "
               "set Regularisation = 0.3");
  Problem<2> problem(text);
  check_direction(problem, false);
}

TEST(Tangent, PressureColumns)
{
  Problem<2> problem(small_scenes::fluid_on_solid());
  check_direction(problem, true);
}

TEST(Tangent, ConsistentMass)
{
  Problem<2> problem(small_scenes::free_block(), {"Inertia/Mass=consistent"});
  check_direction(problem, false);
}

TEST(Tangent, MeanDilatation)
{
  std::string text = small_scenes::free_block();
  text.replace(text.find("= inertia"), 9, "= inertia, mean dilatation");
  Problem<2> problem(text);
  check_direction(problem, false);
}

TEST(Tangent, MixedPressureOfSolids)
{
  std::string text = small_scenes::free_block();
  text.replace(text.find("= inertia"), 9, "= inertia, mixed pressure");
  text.replace(text.find("neo hookean"), 11, "isochoric neo hookean");
  text.replace(text.find("ratio = 0.3"), 11, "ratio = 0.4999");
  for (const bool pressures : {false, true})
    {
      Problem<2> problem(text);
      check_direction(problem, pressures);
    }
}

TEST(Tangent, MixedPressureOfSolidsBesideAFluid)
{
  for (const bool pressures : {false, true})
    {
      Problem<2> flat(small_scenes::water_on_rubber(2));
      check_direction(flat, pressures);
      Problem<3> deep(small_scenes::water_on_rubber(3));
      check_direction(deep, pressures);
    }
}

TEST(Tangent, PhasesHavePressuresOfTheirOwn)
{
  Problem<2>  problem(small_scenes::water_on_rubber(2));
  const auto &system = *problem.system;
  // 5 x 4 nodes of the water and 3 x 3 of the rubber, 3 of them common.
  EXPECT_EQ(system.n_global_pressures(), 20u + 9u);
  EXPECT_EQ(system.n_global(), 2 * 5 * 6 + 20u + 9u);
  unsigned int common = 0;
  for (const auto &of : system.owned_pressures())
    if (of.phase != 0 &&
        system.first_pressure(of.node) != system.pressure(of.node, of.phase))
      {
        EXPECT_EQ(system.first_pressure(of.node), system.pressure(of.node, 0));
        EXPECT_NEAR(system.cloud.position(of.node)[1], 0.2, 1e-12);
        ++common;
      }
  EXPECT_EQ(common, 3u);
}

TEST(Tangent, WallFriction)
{
  std::string text = small_scenes::fluid_on_solid();
  text.replace(text.find(", viscosity"), 11, ", viscosity, wall friction");
  // So large that an error in its tangent shows.
  Problem<2> problem(text, {"Wall friction/Coefficient=1e6"});
  check_direction(problem, false);
}

TEST(Tangent, Contact)
{
  // Newmark's velocity at increments near zero is about -v_n: blocks that part
  // are those whose nodes push each other.
  Problem<2> problem(small_scenes::two_blocks(0.01, -20.));
  check_direction(problem, false);

  Vector with, without;
  problem.system->initialize(with);
  problem.system->initialize(without);
  problem.assembler->assemble(
    problem.table, problem.time, problem.fields, 1., false, with);
  auto others = problem.terms;
  others.erase(std::remove_if(others.begin(),
                              others.end(),
                              [](const auto &term) {
                                return term->name() == "contact";
                              }),
               others.end());
  Assembler<2>(others, *problem.system)
    .assemble(problem.table, problem.time, problem.fields, 1., false, without);
  without -= with;
  EXPECT_GT(without.l2_norm(), 0.1 * with.l2_norm()) << "nothing pushes";
}

TEST(Tangent, SpringFoundation)
{
  std::string text = small_scenes::free_block();
  text.replace(text.find("= inertia"), 9, "= inertia, spring foundation");
  Problem<2> problem(text, {"Spring foundation/Stiffness=1e8"});
  check_direction(problem, false);
}

TEST(Tangent, SymmetricWithoutViscosity)
{
  std::string text = small_scenes::fluid_on_solid();
  text.replace(text.find(", viscosity"), 11, "");
  text.replace(text.find("set Viscosity    = 5"), 20, "");
  Problem<2> problem(text);
  Vector     residual;
  problem.system->initialize(residual);
  // The pressure unit brings all blocks to one scale.
  const double unit = 1000. * 0.1 * 0.1 * problem.time.newmark.alpha1;
  problem.assembler->assemble(
    problem.table, problem.time, problem.fields, unit, true, residual);
  const unsigned int         n = problem.system->n_owned();
  dealii::FullMatrix<double> K(n, n);
  int                       *start, *column;
  double                    *values;
  problem.system->matrix().epetra().ExtractCrsDataPointers(start,
                                                           column,
                                                           values);
  for (unsigned int i = 0; i < n; ++i)
    for (int k = start[i]; k < start[i + 1]; ++k)
      K(i, column[k]) = values[k];
  double largest = 0., difference = 0.;
  for (unsigned int i = 0; i < n; ++i)
    for (unsigned int j = 0; j < n; ++j)
      {
        largest    = std::max(largest, std::abs(K(i, j)));
        difference = std::max(difference, std::abs(K(i, j) - K(j, i)));
      }
  EXPECT_LT(difference, 1e-12 * largest);
}

TEST(Tangent, NoFluidNoPressure)
{
  Problem<2> problem(small_scenes::free_block());
  EXPECT_EQ(problem.system->n_global_pressures(), 0u);
  EXPECT_EQ(problem.system->n_global(),
            problem.system->owned_nodes().size() * 2);
  EXPECT_FALSE(problem.particles.columns.J.exists());
}
