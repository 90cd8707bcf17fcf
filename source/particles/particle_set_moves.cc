// How points move: what a set of displacements would do, whether it may, and
// it.
#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/particles/particle_set.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace selkie
{
  /// What a set of displacements does to the points of this rank.
  template <int dim>
  struct ParticleSet<dim>::Motion
  {
    std::vector<dealii::Point<dim>> positions;
    std::vector<Iterator>           leaving;
    unsigned long long              n_leaving    = 0;
    double                          leaving_mass = 0.;
    std::string                     not_finite; ///< names such a point
    std::string                     first;      ///< names a leaving point
    bool at_open_wall = false; ///< one leaves that already stands there
  };


  template <int dim>
  typename ParticleSet<dim>::Motion
  ParticleSet<dim>::plan(
    const std::vector<dealii::Tensor<1, dim>> &displacements) const
  {
    AssertThrow(displacements.size() == points.n_locally_owned_particles(),
                dealii::ExcDimensionMismatch(
                  displacements.size(), points.n_locally_owned_particles()));
    if (scene.lagrangian_mesh())
      return plan_with_mesh(displacements);
    const CellLocator<dim> locator(mesh);
    const double           margin = 1e-5 * locator.smallest_spacing();
    Motion                 motion;
    motion.positions.reserve(displacements.size());
    auto displacement = displacements.begin();
    for (auto point = points.begin(); point != points.end();
         ++point, ++displacement)
      {
        const dealii::Point<dim> x      = point->get_location() + *displacement;
        dealii::Point<dim>       inside = x;
        bool                     leaves = false;
        for (unsigned int d = 0; d < dim; ++d)
          {
            if (!std::isfinite(x[d]) && motion.not_finite.empty())
              motion.not_finite = describe(point, x);
            const bool below = x[d] < locator.lower()[d];
            const bool above = x[d] > locator.upper()[d];
            leaves |= below || above;
            if (below || above)
              motion.at_open_wall |=
                scene.domain.walls[2 * d + above].condition ==
                  NodeCondition::free &&
                std::abs(point->get_location()[d] -
                         (above ? locator.upper() : locator.lower())[d]) <
                  100. * margin;
            inside[d] = std::clamp(x[d],
                                   locator.lower()[d] + margin,
                                   locator.upper()[d] - margin);
          }
        motion.positions.push_back(inside);
        if (!leaves)
          continue;
        ++motion.n_leaving;
        motion.leaving_mass += columns.mass(point->get_properties());
        motion.leaving.push_back(point);
        if (motion.first.empty())
          motion.first = describe(point, x);
      }
    return motion;
  }


  template <int dim>
  typename ParticleSet<dim>::Motion
  ParticleSet<dim>::plan_with_mesh(
    const std::vector<dealii::Tensor<1, dim>> &displacements) const
  {
    Motion motion;
    motion.positions.reserve(displacements.size());
    auto displacement = displacements.begin();
    for (auto point = points.begin(); point != points.end(); ++point)
      {
        motion.positions.push_back(point->get_location() + *displacement++);
        if (!std::isfinite(motion.positions.back().norm_square()) &&
            motion.not_finite.empty())
          motion.not_finite = describe(point, motion.positions.back());
      }
    return motion;
  }


  template <int dim>
  void
  ParticleSet<dim>::check(const Motion &motion) const
  {
    throw_on_all_ranks<NumericalFailure>(
      communicator(),
      motion.not_finite.empty()
        ? ""
        : "A displacement is not finite: the " + motion.not_finite + ".");
    if (scene.leaving != LeavingPolicy::stop)
      return;
    const std::string failure =
      motion.first.empty()
        ? ""
        : "A point leaves the domain: the " + motion.first + ".";
    throw_on_all_ranks<CertainFailure>(
      communicator(),
      motion.at_open_wall
        ? failure + " The wall is free, and it stands there already."
        : "");
    throw_on_all_ranks<NumericalFailure>(communicator(), failure);
  }


  template <int dim>
  void
  ParticleSet<dim>::check_move(
    const std::vector<dealii::Tensor<1, dim>> &displacements) const
  {
    check(plan(displacements));
  }


  template <int dim>
  void
  ParticleSet<dim>::move(
    const std::vector<dealii::Tensor<1, dim>> &displacements)
  {
    const Motion motion = plan(displacements);
    check(motion);

    auto position = motion.positions.begin();
    for (auto &point : points)
      point.set_location(*position++);
    if (scene.lagrangian_mesh())
      return;

    using dealii::Utilities::MPI::sum;
    const auto   n    = sum(motion.n_leaving, communicator());
    const double mass = sum(motion.leaving_mass, communicator());
    if (scene.leaving == LeavingPolicy::keep)
      accounting.kept_at_wall += n;
    else if (n > 0)
      {
        remove(motion.leaving);
        accounting.removed += n;
        accounting.removed_mass += mass;
      }
    sort();
  }


#define INSTANTIATE(dim)                                \
  template void ParticleSet<dim>::check_move(           \
    const std::vector<dealii::Tensor<1, dim>> &) const; \
  template void ParticleSet<dim>::move(                 \
    const std::vector<dealii::Tensor<1, dim>> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
