#pragma once

#include <selkie/particles/fields.h>
#include <selkie/scene/scene.h>

#include <deal.II/base/mpi.h>

#include <deal.II/distributed/tria.h>

#include <deal.II/particles/particle_handler.h>

#include <memory>
#include <vector>

namespace selkie
{
  /// The columns of a scene's material points. Those of an effect that the
  /// scene does not list do not exist.
  template <int dim>
  struct ParticleColumns
  {
    Column<double>                  body;   ///< index into Scene::bodies
    Column<double>                  mass;   ///< kg (kg/m in 2D)
    Column<double>                  volume; ///< reference volume V_0
    Column<dealii::Tensor<1, dim>>  lambda; ///< LME multiplier, warm start
    Column<dealii::Tensor<1, dim>>  X;      ///< reference position (m)
    Column<dealii::Tensor<1, dim>>  v, a;   ///< with inertia
    Column<dealii::Tensor<2, dim>>  F;      ///< with a solid
    Column<double>                  J;      ///< with a fluid
    Column<double>                  pressure; ///< with a fluid (Pa), for output
    Column<dealii::Tensor<2, dim>>  grad_v; ///< with TPIC
    Column<double>                  traction_area; ///< with traction (m^2)

    ParticleColumns(const Scene<dim> &scene, ParticleFields &fields);
  };

  /// What happened to points since the start: they never vanish silently.
  struct ParticleAccounting
  {
    unsigned long long seeded = 0, removed = 0, kept_at_wall = 0;
    double             seeded_mass = 0, removed_mass = 0;
  };

  /**
   * The material points: a ParticleHandler and its typed columns. This class
   * seeds, moves and accounts for them; deal.II 9.4.1's ways of losing a point
   * (a jump past the ghost layer, round-off on a face or vertex) are handled
   * here and nowhere else.
   */
  template <int dim>
  class ParticleSet
  {
  public:
    ParticleSet(const Scene<dim>                                  &scene,
                dealii::parallel::distributed::Triangulation<dim> &mesh);

    /// Seeds all bodies: equally spaced lattice in each cell (jittered by
    /// `Body::jitter`, with a generator seeded by the global cell so that any
    /// partition gives the same points), kept where inside the shape;
    /// volumes are scaled so that they sum exactly to Shape::volume(). Then
    /// repartitions the mesh by particle count (cell weights).
    /// Throws SceneError when a body gets no point.
    void
    seed();

    /**
     * Moves every locally owned point by its displacement (indexed by
     * ParticleHandler::iteration order), applies the leaving policy, sorts
     * and migrates; in sub-steps when the largest displacement exceeds 0.9 of
     * the smallest local h. Checks count and mass after each sort.
     * Points closer to a wall than 1e-5 h are put at that distance.
     * Throws NumericalFailure naming the point (id, position, body) when one
     * leaves and the policy is `stop`, and when count or mass changed.
     */
    void
    move(const std::vector<dealii::Tensor<1, dim>> &displacements);

    /// Finds cells again and migrates (after repartitioning).
    void
    sort();

    const Scene<dim>           &scene;
    ParticleFields              fields; // before columns: it registers them
    const ParticleColumns<dim>  columns;
    ParticleAccounting          accounting;

    dealii::Particles::ParticleHandler<dim> &
    handler();
    const dealii::Particles::ParticleHandler<dim> &
    handler() const;

    MPI_Comm
    communicator() const;
  };
} // namespace selkie
