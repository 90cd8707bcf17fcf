#pragma once

#include <selkie/base/types.h>
#include <selkie/terms/patch_state.h>

#include <memory>
#include <string>
#include <vector>

namespace selkie
{
  /// What a term reads and what it writes. Kernels are composed from it at
  /// set-up: nothing else is gathered, computed or integrated.
  struct TermUse
  {
    // Read, of PatchState:
    bool kinematics        = false; ///< f, J, c
    bool velocity_gradient = false; ///< l
    bool velocity          = false; ///< sum N_a v_a
    bool pressure          = false; ///< p
    bool acceleration      = false; ///< sum N_a a_a
    bool increment         = false; ///< sum N_a du_a

    // Written:
    bool stress   = false; ///< PointForm::flux and stiffness
    bool source   = false; ///< PointForm::source
    bool mass     = false; ///< PointForm::mass
    bool volume   = false; ///< the pressure equation: p_source, coupling, …
    bool mean     = false; ///< MeanForm
    bool at_nodes = false; ///< add_at_nodes() does something

    /// dissipation() or external_work() is not zero; they find the increment,
    /// too.
    bool energy = false;

    TermUse &
    operator|=(const TermUse &other);
  };

  /// The nodal state of a Newton iterate, for terms that act at nodes.
  struct NodeState
  {
    const Vector &lumped_mass; ///< at displacement unknowns (kg)
    const Vector &acceleration;
  };

  /**
   * One weak-form term: the kernel of an effect. It adds its forces and its
   * consistent tangent to the points of a patch, or to the nodes.
   */
  template <int dim>
  class Term
  {
  public:
    virtual ~Term() = default;

    virtual std::string
    name() const = 0;

    virtual TermUse
    use() const = 0;

    /// Whether the term contributes at the points of such patches.
    virtual bool
    acts_on(const PatchKind &kind) const = 0;

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

    /// Whether its tangent is symmetric, or near enough for a symmetric solver.
    /// The second argument is the smallest node spacing (m).
    virtual bool
    symmetric(const Newmark & /*newmark*/, const double /*h*/) const
    {
      return true;
    }

    /// The acceleration that it gives to all matter (m/s^2): a measure of the
    /// forces in play, for Newton's tolerance.
    virtual double
    acceleration_scale() const
    {
      return 0.;
    }

    /// Power that the term turns into heat at the points of a patch (W).
    virtual double
    dissipation(const PatchState<dim> & /*state*/) const
    {
      return 0.;
    }

    /// Work that the term's forces do in the step (J), if they are external.
    virtual double
    external_work(const PatchState<dim> & /*state*/) const
    {
      return 0.;
    }
  };
} // namespace selkie
