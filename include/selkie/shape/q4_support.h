#pragma once

#include <selkie/base/types.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>
#include <selkie/shape/occupancy.h>
#include <selkie/shape/support_table.h>

#include <deal.II/lac/affine_constraints.h>

#include <array>

namespace selkie
{
  /**
   * Fills the support table with the (multi)linear functions of FE_Q(1) on the
   * cells: for `q4 mpm` on the background mesh at the points' places; for
   * `q4 fem` at the Gauss points of a mesh that moves with the matter. Its
   * gradients at t_n follow from those on the mesh at rest, grad_n N_a =
   * F_n^{-T} grad_0 N_a: F_n at a Gauss point is the finite element's own.
   *
   * Hanging nodes are no unknowns: their functions are shared among their
   * masters' (the patch's node list holds these).
   */
  template <int dim>
  class Q4Support
  {
  public:
    Q4Support(const Scene<dim> &scene, const NodeCloud<dim> &cloud);

    /// Material points, or all Gauss points.
    void
    fill_points(const ParticleSet<dim> &particles,
                SupportTable<dim>      &table) const;

    /// For `q4 fem`: the Gauss points of the faces that carry tractions, as
    /// patches of their own. @p displacement is the nodes' at t_n.
    void
    add_loaded_faces(const std::array<Vector, dim> &displacement,
                     SupportTable<dim>             &table) const;

    /// Gives hanging nodes what their masters' functions have there.
    /// Collective; the field's ghosts are up to date afterwards.
    void
    interpolate_hanging(Vector &field) const;

    /// The phases of the nodes that the table names, on any rank. Collective.
    Occupancy<dim>
    occupancy(const SupportTable<dim> &table) const;

  private:
    void
    append_nodes(Patch<dim> &patch, SupportTable<dim> &table) const;
    void
    evaluate(const Patch<dim>         &patch,
             const unsigned int        q,
             const dealii::Point<dim> &reference,
             SupportTable<dim>        &table) const;

    const Scene<dim>                 &scene;
    const NodeCloud<dim>             &cloud;
    dealii::AffineConstraints<double> hanging; ///< of the scalar FE_Q(1)
  };
} // namespace selkie
