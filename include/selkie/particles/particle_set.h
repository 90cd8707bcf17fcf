#pragma once

#include <selkie/mesh/cell_locator.h>
#include <selkie/mesh/forest.h>
#include <selkie/particles/fields.h>
#include <selkie/particles/seed.h>
#include <selkie/scene/scene.h>

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/particles/particle_handler.h>

#include <boost/signals2/connection.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace selkie
{
  /// The columns of a scene's material points. Those of an effect that the
  /// scene does not list do not exist.
  template <int dim>
  struct ParticleColumns
  {
    Column<double>                 body;   ///< index into Scene::bodies
    Column<double>                 mass;   ///< kg (kg/m in 2D)
    Column<double>                 volume; ///< reference volume V_0
    Column<dealii::Tensor<1, dim>> lambda; ///< LME: multiplier, warm start
    Column<dealii::Tensor<1, dim>> X;      ///< reference position (m)
    Column<dealii::Tensor<1, dim>> v, a;   ///< with inertia
    Column<dealii::Tensor<2, dim>> F; ///< with a solid or a Lagrangian mesh
    Column<double>                 J; ///< with a fluid
    Column<double> mean_J;            ///< of the patch, with mean dilatation
    Column<double> pressure;          ///< with a fluid (Pa), for output
    Column<dealii::Tensor<2, dim>> grad_v;        ///< with TPIC
    Column<double>                 traction_area; ///< with traction (m^2)

    ParticleColumns(const Scene<dim> &scene, ParticleFields &fields);
  };

  /// What happened to points since the start, on all ranks: they never vanish
  /// silently.
  struct ParticleAccounting
  {
    unsigned long long seeded = 0, removed = 0, kept_at_wall = 0;
    unsigned long long split       = 0; ///< points more by splitting
    unsigned long long merged      = 0; ///< points fewer by merging
    double             seeded_mass = 0, removed_mass = 0;

    /// How many there should be.
    unsigned long long
    present() const
    {
      return seeded + split - removed - merged;
    }

    /// The id of the next new point: no id is given twice.
    dealii::types::particle_index
    next_id() const
    {
      return seeded + split;
    }
  };

  /// ParticleSet::imbalance() that is put up with.
  constexpr double most_imbalance = 1.2;

  /**
   * The material points: a ParticleHandler and its typed columns. This class
   * seeds, moves and accounts for them.
   *
   * It finds the points' cells and sends them to their ranks itself, by
   * CellLocator, because deal.II's sort (9.4 to 9.6) loses points in two ways:
   * those that jump past the ghost layer, often without a signal, and, by
   * round-off, some that lie on a face or vertex. Here a point may jump any
   * distance. The handler's own sort must not be called.
   *
   * All member functions but the accessors are collective, and errors are
   * thrown on all ranks.
   */
  template <int dim>
  class ParticleSet
  {
  public:
    using Mesh = dealii::parallel::distributed::Triangulation<dim>;

    /// The mesh is one of make_background_mesh().
    ParticleSet(const Scene<dim> &scene, Mesh &mesh);
    ~ParticleSet();
    ParticleSet(const ParticleSet &) = delete;
    ParticleSet &
    operator=(const ParticleSet &) = delete;

    /// Seeds all bodies (see seed_points()), gives the points mass, velocity
    /// and the undeformed state, and calls rebalance().
    /// Throws SceneError when a body gets no point or two bodies overlap.
    void
    seed();

    /// What the points of the dearest rank cost, over the mean; see
    /// rebalance(). Collective.
    double
    imbalance() const;

    /// Repartitions the mesh by what the points of its cells cost, and takes
    /// them along: those with a pressure 1.7 times what the others do, as was
    /// measured (doc/performance.md, "What a point costs"). Not by times of the
    /// run itself: these differ from one to the next, and with them the
    /// partition and round-off. Node clouds and whatever else hangs on the mesh
    /// must be built anew.
    void
    rebalance();

    /// What a cell's points cost; those of a cell's children, if it is to be
    /// joined from them.
    unsigned int
    weight(const typename Mesh::cell_iterator &cell) const;

    /// The same by other weights than the points.
    void
    rebalance(const CellWeight<dim> &weight);

    /// Lets @p change make the mesh anew, while there are no points, and puts
    /// them into their cells again. Those of a Lagrangian mesh are seeded anew
    /// instead, in the undeformed state and of the same mass altogether: see
    /// recall_points(). What hangs on the mesh must be built anew.
    void
    remesh(const std::function<void()> &change);

    /// A point by itself.
    struct Record
    {
      dealii::types::particle_index id = 0;
      dealii::Point<dim>            x;
      std::vector<double>           properties;
    };

    /// Takes points of this rank out and puts others in, anywhere in the
    /// domain and of the same mass altogether. Books what became of the number,
    /// as given for all ranks.
    void
    replace(const std::vector<dealii::Particles::ParticleIterator<dim>> &gone,
            const std::vector<Record>                                   &born,
            const unsigned long long                                     split,
            const unsigned long long merged);

    /// Throws NumericalFailure, on every rank, when move() would have to: a
    /// displacement is not finite, or a point leaves and the policy is `stop`.
    /// Changes nothing. Collective.
    void
    check_move(const std::vector<dealii::Tensor<1, dim>> &displacements) const;

    /**
     * Moves every locally owned point by its displacement (m), in the order
     * in which the handler iterates at the call, applies the leaving policy,
     * finds the points' cells and sends them to their ranks.
     *
     * With a Lagrangian mesh points stay in their cells, wherever these go.
     *
     * A point closer to a wall than wall_margin() is put at that distance.
     * Of the points outside the domain, `keep` puts them there as well (and
     * counts them in `accounting`), `remove` takes them out and books number
     * and mass, and `stop` throws NumericalFailure naming one (id, position,
     * body); then, as when a displacement is not finite, no point has moved.
     */
    void
    move(const std::vector<dealii::Tensor<1, dim>> &displacements);

    /// Finds the cells of all points again and sends them to their ranks: for
    /// positions that were set by hand. Throws NumericalFailure naming a point
    /// outside the domain, or when count or mass of all points disagree with
    /// `accounting`.
    void
    sort();

    /// 1e-5 of the smallest h (m).
    double
    wall_margin() const;

    const Scene<dim>          &scene;
    ParticleFields             fields; // before columns: it registers them
    const ParticleColumns<dim> columns;
    ParticleAccounting         accounting;

    dealii::Particles::ParticleHandler<dim> &
    handler();
    const dealii::Particles::ParticleHandler<dim> &
    handler() const;

    MPI_Comm
    communicator() const;

  private:
    using Iterator = dealii::Particles::ParticleIterator<dim>;
    struct Motion;

    /// Of points in a step, in tenths of one without a pressure.
    template <typename Points>
    unsigned int
    cost(const Points &some) const;
    /// Replaces all points by those of seed_points(). Returns their mass.
    double
    put_seeds();
    void
    displace_at_start();
    Motion
    plan(const std::vector<dealii::Tensor<1, dim>> &displacements) const;
    Motion
    plan_with_mesh(
      const std::vector<dealii::Tensor<1, dim>> &displacements) const;
    void
    check(const Motion &motion) const;
    void
    remove(const std::vector<Iterator> &points);
    void
    insert(const std::vector<double>                 &record,
           const typename CellLocator<dim>::Location &place);
    std::vector<dealii::types::subdomain_id>
    owners_of(const std::vector<dealii::Point<dim>> &positions) const;
    void
    deliver(const std::vector<std::vector<double>> &records);
    std::string
    describe(const Iterator &point, const dealii::Point<dim> &x) const;
    void
    check_accounting() const;

    Mesh                                   &mesh;
    const dealii::MappingQ1<dim>            mapping;
    dealii::Particles::ParticleHandler<dim> points;
    const std::vector<unsigned int>         costs; ///< of a point, by body
    boost::signals2::scoped_connection      weight_connection;
  };
} // namespace selkie
