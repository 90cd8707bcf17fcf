#include <selkie/output/audit.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "../temporary_folder.h"
#include "block.h"

using namespace selkie;
using namespace selkie::test;

namespace
{
  /// The energy (B18) of diag(a, b, 1).
  double
  neo_hookean_energy(const double a, const double b)
  {
    const double G = solid_E / (2 * (1 + solid_nu));
    const double Lambda =
      solid_E * solid_nu / ((1 + solid_nu) * (1 - 2 * solid_nu));
    const double J = a * b;
    return G / 2 * (a * a + b * b - 2) - G * std::log(J) +
           Lambda / 4 * (J * J - 1 - 2 * std::log(J));
  }

  /// Psi with Psi' = -p, p = K/n (J^-n - 1), Psi(1) = 0.
  double
  fluid_energy(const double J)
  {
    return fluid_K / fluid_n *
           ((std::pow(J, 1 - fluid_n) - 1) / (fluid_n - 1) + J - 1);
  }

  template <int dim>
  void
  check_two_blocks()
  {
    Matter<dim>            matter(two_blocks<dim>());
    dealii::Tensor<1, dim> v;
    v[0] = 2.;
    v[1] = -1.;
    dealii::Tensor<2, dim> F;
    for (unsigned int i = 0; i < dim; ++i)
      F[i][i] = 1.;
    F[0][0]           = 1.1;
    F[1][1]           = 0.8;
    const double J    = 0.97;
    const double spin = 3.;
    matter.set_state(v, spin, F, J);
    const Audit found = audit(matter.particles);

    const double V       = std::pow(0.5, dim - 1) * 0.25;
    const double solid_m = solid_rho * V, fluid_m = fluid_rho * V;
    const double m  = solid_m + fluid_m;
    const double xc = (0.375 * solid_m + 0.625 * fluid_m) / m;
    EXPECT_NEAR(found.mass, m, 1e-12 * m);
    EXPECT_NEAR(found.volume, V * (0.88 + J), 1e-12);
    EXPECT_NEAR(found.min_J, 0.88, 1e-14);
    EXPECT_NEAR(found.max_J, 0.97, 1e-14);
    EXPECT_NEAR(found.center[0], xc, 1e-12);
    EXPECT_NEAR(found.center[1], 0.5, 1e-12);
    EXPECT_NEAR(found.strain, V * neo_hookean_energy(1.1, 0.8), 1e-9);
    EXPECT_NEAR(found.compression, V * fluid_energy(J), 1e-9);
    EXPECT_NEAR(found.potential, m * gravity * 0.5, 1e-9);

    // Lattices of 4 (x) and 8 (y) points, spacing 1/16, about their middles.
    const double var_x = 15. / 12 / 256, var_y = 63. / 12 / 256;
    const double about_middle = m * (0.125 * 0.125 + var_x + var_y);
    const double px = m * v[0], py = m * (v[1] + spin * (xc - 0.5));
    EXPECT_NEAR(found.momentum[0], px, 1e-11 * m);
    EXPECT_NEAR(found.momentum[1], py, 1e-11 * m);
    EXPECT_NEAR(found.angular_momentum[2],
                0.5 * py - 0.5 * px + spin * about_middle +
                  v[1] * m * (xc - 0.5),
                1e-11 * m);
    EXPECT_NEAR(found.kinetic,
                0.5 * m * v * v + spin * v[1] * m * (xc - 0.5) +
                  0.5 * spin * spin * about_middle,
                1e-11 * m);
    EXPECT_NEAR(found.energy(),
                found.kinetic + found.strain + found.compression +
                  found.potential,
                1e-9);
  }
} // namespace

TEST(AuditMPI, TwoBlocks2D)
{
  check_two_blocks<2>();
}

TEST(AuditMPI, TwoBlocks3D)
{
  check_two_blocks<3>();
}

TEST(AuditMPI, InvertedPointGivesInfiniteEnergyAndNoException)
{
  Matter<2>            matter(two_blocks<2>());
  dealii::Tensor<2, 2> F;
  F[0][0] = 1.;
  F[1][1] = -1.;
  matter.set_state(dealii::Tensor<1, 2>(), 0., F, 1.);
  const Audit found = audit(matter.particles);
  EXPECT_TRUE(std::isinf(found.strain));
  EXPECT_EQ(found.min_J, -1.);
  EXPECT_EQ(found.compression, 0.);
}

TEST(AuditMPI, ColumnsOfAbsentEffectsAreAbsent)
{
  Scene<2> scene = two_blocks<2>();
  scene.bodies.pop_back();
  scene.fluid_pressure.reset();
  scene.gravity.reset();
  scene.inertia.reset();
  Matter<2>             matter(scene);
  const Audit           found = audit(matter.particles);
  const TemporaryFolder folder(MPI_COMM_WORLD);
  const bool            root =
    dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  Statistics statistics;
  statistics.open(folder.path + "/statistics.csv", root);
  set_columns(found, matter.particles, statistics);
  statistics.end_row();
  if (!root)
    return;
  std::ifstream file(folder.path + "/statistics.csv");
  std::string   header;
  std::getline(file, header);
  EXPECT_EQ(header,
            "strain energy (J/m),mass (kg/m),volume (m^2),min J,max J,"
            "center of mass x (m),center of mass y (m)");
}
