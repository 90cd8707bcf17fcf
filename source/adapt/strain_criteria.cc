#include <selkie/adapt/strain_criteria.h>
#include <selkie/base/types.h>
#include <selkie/mesh/background_mesh.h>

#include <deal.II/base/geometry_info.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Green's strain.
    template <int dim>
    Tensor<2, dim>
    strain(const Tensor<2, dim> &F)
    {
      return 0.5 * (transpose(F) * F - unit_symmetric_tensor<dim>());
    }

    /// Strains at nodes, recovered from those in the cells (Zienkiewicz and
    /// Zhu 1987): at a corner the mean of the cells around it, by volume.
    template <int dim>
    class RecoveredStrain
    {
    public:
      /// @param strains the cells' mean strains; of those without a volume
      /// there are none
      RecoveredStrain(const NodeCloud<dim>                 &cloud,
                      const std::vector<OccupiedCell<dim>> &cells,
                      const std::vector<Tensor<2, dim>>    &strains,
                      const std::vector<double>            &volumes)
        : cloud(cloud)
        , volume(cloud.partitioner())
      {
        for (auto &component : sum)
          component.reinit(cloud.partitioner());
        for (unsigned int i = 0; i < cells.size(); ++i)
          if (volumes[i] > 0.)
            for (const unsigned int node : cloud.corners(cells[i].cell))
              {
                volume.local_element(node) += volumes[i];
                for (unsigned int c = 0; c < sum.size(); ++c)
                  sum[c].local_element(node) +=
                    volumes[i] * strains[i][index(c)];
              }
        const auto collect = [](Vector &field) {
          field.compress(VectorOperation::add);
          field.update_ghost_values();
        };
        collect(volume);
        for (auto &component : sum)
          collect(component);
      }

      /// At a place in a cell of the mesh, by bilinear interpolation.
      Tensor<2, dim>
      operator()(const typename NodeCloud<dim>::Cell &cell,
                 const Point<dim>                    &reference) const
      {
        Tensor<2, dim> E;
        const auto     corners = cloud.corners(cell);
        for (unsigned int v = 0; v < corners.size(); ++v)
          {
            const double share =
              GeometryInfo<dim>::d_linear_shape_function(reference, v) /
              volume.local_element(corners[v]);
            for (unsigned int c = 0; c < sum.size(); ++c)
              E[index(c)] += share * sum[c].local_element(corners[v]);
          }
        return E;
      }

    private:
      static TableIndices<2>
      index(const unsigned int c)
      {
        return {c / dim, c % dim};
      }

      const NodeCloud<dim>         &cloud;
      Vector                        volume;
      std::array<Vector, dim * dim> sum; ///< of volume times strain
    };

    /// How often a cell must be halved (joined, if negative) for its figure to
    /// be just below what is allowed.
    /// @param ratio of the figure to what is allowed
    /// @param order the power of the cells' width with which it goes down
    int
    halvings(const double ratio, const double order)
    {
      constexpr int most = 32; // more than any mesh has
      if (ratio <= 0.)
        return -most;
      return std::clamp<int>(std::floor(std::log2(ratio) / order) + 1,
                             -most,
                             most);
    }

    /// The level of a cell and so many more, within the scene's limits.
    template <int dim>
    unsigned int
    level_after(const int                            halvings,
                const typename NodeCloud<dim>::Cell &cell,
                const Scene<dim>                    &scene)
    {
      const int base = base_level(scene.domain);
      return std::clamp(cell->level() + halvings,
                        base - int(scene.adaptivity->coarser),
                        base + int(scene.adaptivity->finer));
    }

    /// What a mesh of other levels would change.
    struct Gain
    {
      double squares = 0., halved_squares = 0.; ///< of the cells' errors
      double cells = 0., joined = 0.;

      void
      add(const unsigned int level,
          const unsigned int wanted,
          const double       square)
      {
        squares += square;
        halved_squares += wanted > level ? square : 0.;
        cells += 1.;
        joined += wanted < level;
      }

      /// A new mesh is worth its price if a fifth of the squared error is in
      /// cells that would be halved, or if half of the cells could be joined.
      /// Collective.
      bool
      is_worth_it(const MPI_Comm comm) const
      {
        const auto sum = [comm](const double x) {
          return Utilities::MPI::sum(x, comm);
        };
        return sum(halved_squares) > 0.2 * sum(squares) ||
               sum(joined) > 0.5 * sum(cells);
      }
    };

    /// The levels that a limit of the errors asks for, in cells with solids.
    /// The error is the norm of the difference between strain and recovered
    /// strain.
    /// @param volumes of the solids in the cells
    template <int dim, typename ForEachStrain>
    void
    level_by_error(const ParticleSet<dim>         &particles,
                   const ForEachStrain            &for_each_strain,
                   const RecoveredStrain<dim>     &recovered,
                   const std::vector<double>      &volumes,
                   std::vector<OccupiedCell<dim>> &cells)
    {
      const Scene<dim>   &scene = particles.scene;
      const MPI_Comm      comm  = particles.communicator();
      std::vector<double> squares(cells.size());
      double              all = 0.;
      for_each_strain(
        [&](const unsigned int i, const Tensor<2, dim> &E, const auto &point) {
          const double V = particles.columns.volume(point.get_properties());
          squares[i] +=
            V * (E - recovered(cells[i].cell, point.get_reference_location()))
                  .norm_square();
          all += V * E.norm_square();
        });
      const double limit = scene.adaptivity->strain_error *
                           std::sqrt(Utilities::MPI::sum(all, comm));
      if (limit == 0.)
        return;
      // In L2, of linear functions: h, and the root of the cell's volume
      // (Zienkiewicz and Zhu 1987).
      constexpr double          order = 1. + dim / 2.;
      std::vector<unsigned int> levels(cells.size());
      Gain                      gain;
      for (unsigned int i = 0; i < cells.size(); ++i)
        if (volumes[i] > 0.)
          {
            levels[i] =
              level_after<dim>(halvings(std::sqrt(squares[i]) / limit, order),
                               cells[i].cell,
                               scene);
            gain.add(cells[i].cell->level(), levels[i], squares[i]);
          }
      const bool changes = gain.is_worth_it(comm);
      for (unsigned int i = 0; i < cells.size(); ++i)
        if (volumes[i] > 0.)
          {
            const unsigned int level = cells[i].cell->level();
            cells[i].level =
              std::max(cells[i].level, changes ? levels[i] : level);
          }
    }

    /// The levels that a limit of the strain's variation in a cell asks for: it
    /// goes down with the cell's width where strain is smooth.
    template <int dim>
    void
    level_by_variation(const Scene<dim>               &scene,
                       const std::vector<double>      &variation,
                       const double                    limit,
                       std::vector<OccupiedCell<dim>> &cells)
    {
      for (unsigned int i = 0; i < cells.size() && limit > 0.; ++i)
        cells[i].level =
          std::max(cells[i].level,
                   level_after<dim>(halvings(variation[i] / limit, 1.),
                                    cells[i].cell,
                                    scene));
    }
  } // namespace


  /// The largest strain of the solids' points in each cell, and the largest
  /// difference of a point's strain from their mean.
  template <int dim>
  void
  limit_strain(const ParticleSet<dim>         &particles,
               const NodeCloud<dim>           &cloud,
               std::vector<OccupiedCell<dim>> &cells)
  {
    const auto                 &wishes = *particles.scene.adaptivity;
    std::vector<double>         largest(cells.size()), variation(cells.size());
    std::vector<double>         volume(cells.size());
    std::vector<Tensor<2, dim>> mean(cells.size());
    const auto                  for_each_strain = [&](const auto &action) {
      for_each_point(
        particles, cells, [&](const unsigned int i, const auto &point) {
          const auto mine = point.get_properties();
          const auto body =
            static_cast<unsigned int>(particles.columns.body(mine));
          if (particles.scene.bodies[body].law->phase() == Phase::solid)
            action(i, strain(particles.columns.F(mine)), point);
        });
    };
    for_each_strain(
      [&](const unsigned int i, const Tensor<2, dim> &E, const auto &point) {
        const double V = particles.columns.volume(point.get_properties());
        largest[i]     = std::max(largest[i], E.norm());
        mean[i] += V * E;
        volume[i] += V;
      });
    for (unsigned int i = 0; i < cells.size(); ++i)
      if (volume[i] > 0.)
        mean[i] /= volume[i];
    for_each_strain(
      [&](const unsigned int i, const Tensor<2, dim> &E, const auto &) {
        variation[i] = std::max(variation[i], (E - mean[i]).norm());
      });
    limit(cells, largest, wishes.strain);
    double scale = 0.;
    for (const double strain : largest)
      scale = std::max(scale, strain);
    scale = Utilities::MPI::max(scale, particles.communicator());
    level_by_variation(particles.scene,
                       variation,
                       wishes.strain_variation * scale,
                       cells);
    if (wishes.strain_error > 0.)
      level_by_error(particles,
                     for_each_strain,
                     RecoveredStrain<dim>(cloud, cells, mean, volume),
                     volume,
                     cells);
  }

  template void
  limit_strain(const ParticleSet<2> &,
               const NodeCloud<2> &,
               std::vector<OccupiedCell<2>> &);
  template void
  limit_strain(const ParticleSet<3> &,
               const NodeCloud<3> &,
               std::vector<OccupiedCell<3>> &);
} // namespace selkie
