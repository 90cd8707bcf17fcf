#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/assembly/system.h>
#include <selkie/base/types.h>
#include <selkie/particles/particle_set.h>
#include <selkie/shape/support_table.h>
#include <selkie/time/newmark.h>
#include <selkie/transfer/nodal_state.h>

#include <deal.II/base/array_view.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <functional>
#include <map>
#include <vector>

namespace selkie
{
  /// Nodal pressures of the phases that have any, in cloud numbering with
  /// ghosts (Pa); NaN at nodes without.
  using StoredPressures = std::map<unsigned int, Vector>;

  /**
   * Points to nodes: lumped mass M_a = sum m N_a and the lumped recovery of
   * velocity and acceleration, v_a = sum m N_a v_p / M_a (with TPIC
   * v_p + grad v_p (x_a - x_p)). Prescribed entries take the prescribed
   * velocity. With Transfer::order k, what the nodes' v and a still miss of the
   * points' is projected and added k - 1 times: the Neumann series of the
   * consistent mass's inverse (FMPM(k): Nairn & Hammerquist, Comput. Methods
   * Appl. Mech. Engrg. 381, 2021). Pressures start from the stored nodal
   * pressure, or, where the node had none, from the points' mean.
   *
   * @param stored_pressures of the last step
   * @param nodes of a Lagrangian mesh, whose velocities and accelerations are
   *        not recovered but kept; else nullptr.
   * @param fields is initialised here on the system's numbering, ghosts
   *        included; fields.x holds zero increments and the pressures.
   */
  template <int dim>
  void
  project(const ParticleSet<dim>  &particles,
          const SupportTable<dim> &table,
          const System<dim>       &system,
          const double             t_n,
          const double             dt,
          const StoredPressures   &stored_pressures,
          const NodalState<dim>   *nodes,
          StepFields              &fields);

  /// Those without any pressure yet.
  template <int dim>
  StoredPressures
  no_pressures(const Scene<dim> &scene, const NodeCloud<dim> &cloud);

  /// Those of the iterate.
  template <int dim>
  void
  store_pressures(const System<dim> &system,
                  const StepFields  &fields,
                  StoredPressures   &stored_pressures);

  /// What correct_volume() found and did.
  struct VolumeCorrection
  {
    double excess = 0; ///< mean of theta - 1 inside the fluid, smoothed in time
    double energy = 0; ///< given to the fluid by it (J), on this rank
  };

  /**
   * Volume drift: points that crowd get a smaller J_n, so that the fluid
   * expands again (formulation.md 4, quadrature.md 4). In a step
   *   J_n *= 1 - rate dt (crowd - mean crowd + excess / 4),
   *   crowd = min(0.2, max(0, theta - 1 - deadband)).
   * theta is the volume of the points over that of the space: both are weighted
   * with the cells' hat functions, whose integrals are known on any mesh, and
   * theta is interpolated with them. Its scatter would make the fluid swell, as
   * only the upper side counts; so the local part is there to move volume, and
   * the drift of the whole is corrected both ways by the mean of theta - 1 over
   * the nodes deep inside the fluid, smoothed over the time 2 / rate lest the
   * pressure jumps. Collective.
   * @param last_excess that of the last step
   */
  template <int dim>
  VolumeCorrection
  correct_volume(const FluidPressure &parameters,
                 const double         dt,
                 const double         last_excess,
                 const System<dim>   &system,
                 SupportTable<dim>   &table);

  /// Interpolates nodal accelerations to the points: the start of a run.
  template <int dim>
  void
  set_accelerations(ParticleSet<dim>        &particles,
                    const SupportTable<dim> &table,
                    const System<dim>       &system,
                    const Vector            &a);

  /// The nodes' increments and end values at one point.
  template <int dim>
  struct PointEnd
  {
    dealii::Tensor<1, dim> du, dv, v, a;
    dealii::Tensor<2, dim> grad_du, grad_v;
    double                 p = 0, J = 1; ///< where there are pressures
  };

  /**
   * Nodes to points at the end of a step, the only writer of point data:
   * positions, velocities (FLIP or TPIC; interpolated with a Lagrangian mesh),
   * accelerations, deformation gradients, and the reset of fluid points' J from
   * the nodal pressure. Nothing is written before write().
   */
  template <int dim>
  class PointUpdate
  {
  public:
    /// Collective.
    /// @throw NumericalFailure, on all ranks, for a pressure that the matter
    /// cannot have and for what ParticleSet::check_move() refuses.
    PointUpdate(ParticleSet<dim>        &particles,
                const SupportTable<dim> &table,
                const System<dim>       &system,
                const Newmark           &newmark,
                const StepFields        &fields);

    /// Shows every owned point as write() would make it: position (m) and
    /// properties.
    void
    preview(const std::function<void(const dealii::Point<dim> &,
                                     const dealii::ArrayView<const double> &)>
              &see) const;

    /// Writes and moves the points. Collective.
    /// @return compression energy added by the reset of J, on all ranks (J)
    double
    write();

    ParticleSet<dim> &particles;

  private:
    /// Of the points, in iteration order.
    using Properties = std::vector<dealii::ArrayView<double>>;

    /// All but the positions. Returns the energy of the J reset on this rank.
    double
    write_to(const Properties &properties) const;
    void
    write_mean_J(const Properties &properties) const;

    const SupportTable<dim>            &table;
    const double                        flip; ///< share of it in this step
    const std::vector<PointEnd<dim>>    values;
    std::vector<dealii::Tensor<1, dim>> displacements;
  };
} // namespace selkie
