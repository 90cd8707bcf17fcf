#pragma once

#include <selkie/base/types.h>
#include <selkie/terms/patch_state.h>

#include <memory>
#include <string>
#include <vector>

namespace selkie
{
  /// What a term needs to find in PatchState; nothing else is computed.
  struct TermNeeds
  {
    bool kinematics        = false; ///< f, J, c
    bool velocity_gradient = false; ///< l
    bool acceleration      = false; ///< sum N_a a_a
    bool increment         = false; ///< sum N_a du_a, for the work of loads
  };

  /// The nodal state of a Newton iterate, for terms that act at nodes.
  struct NodeState
  {
    const Vector &lumped_mass; ///< at displacement unknowns (kg)
    const Vector &acceleration;
    const Vector &displacement;
  };

  /**
   * One weak-form term, which is one physical effect. It adds its forces and
   * its consistent tangent to the points of a patch, or to the nodes.
   */
  template <int dim>
  class Term
  {
  public:
    virtual ~Term() = default;

    virtual std::string
    name() const = 0;

    virtual TermNeeds
    needs() const = 0;

    /// Whether the term contributes at this patch's points.
    virtual bool
    acts_on(const Patch<dim> &patch) const = 0;

    /// Adds to state.forms; the tangent only on request.
    virtual void
    add(PatchState<dim> &state, const bool with_tangent) const = 0;

    /// Adds forces at nodes; @p diagonal, if given, takes the derivative. Owned
    /// entries only.
    virtual void
    add_at_nodes(const NodeState & /*state*/,
                 const Newmark & /*newmark*/,
                 Vector & /*residual*/,
                 Vector * /*diagonal*/) const
    {}

    /// Power that the term turns into heat at the points of a patch (W).
    virtual double
    dissipation(const PatchState<dim> & /*state*/) const
    {
      return 0.;
    }

    /// Work that the term's dead load does in the step (J).
    virtual double
    external_work(const PatchState<dim> & /*state*/) const
    {
      return 0.;
    }
  };
} // namespace selkie
