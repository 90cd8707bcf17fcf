#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/assembly/node_conditions.h>
#include <selkie/assembly/system.h>
#include <selkie/scene/scene.h>

#include <vector>

namespace selkie
{
  /**
   * Walls that push but do not pull (the effect `wall release`), as an active
   * set: a node at which the wall's reaction draws a body of the effect
   * inwards is let go, and held again when it would move into the wall. The
   * conditions at node a, normal n into the domain, are
   *   R_a.n >= 0,  du_a.n >= 0,  (R_a.n)(du_a.n) = 0.
   * Newton solves with a fixed set and its consistent tangent; then the set is
   * corrected, until it stays. A `fixed` wall lets a node go as a whole.
   *
   * Without it a body that starts at a wall stays there ("seizing", note 1 of
   * the paper).
   */
  template <int dim>
  class NodeRelease
  {
  public:
    NodeRelease(const Scene<dim> &scene, NodeConditions<dim> &conditions);

    /// The set with which the last step ended is that with which this one
    /// starts. Call before the unknowns are numbered.
    void
    begin_step(const NodeCloud<dim> &cloud);

    /**
     * Corrects the set after Newton. Collective.
     * @param residual of the solution: at held unknowns the wall's force
     * @param force below which a pull is not one (N)
     * @return whether it has changed: Newton has to go on.
     */
    bool
    correct(const Occupancy<dim> &occupancy,
            const Vector         &residual,
            const double          force,
            System<dim>          &system,
            StepFields           &fields);

    /// The step is done, with the present set.
    void
    end_step()
    {
      kept = released;
    }

    /// With which walls the last step ended, by cloud node, bits as numbers:
    /// for checkpoints.
    const Vector &
    kept_walls(const NodeCloud<dim> &cloud);
    void
    restore(const Vector &walls);

  private:
    /// Walls (bits) that the node should be free from.
    unsigned int
    free_walls(const unsigned int node,
               const Vector      &residual,
               const double       force,
               const System<dim> &system,
               StepFields        &fields) const;
    void
    apply(const NodeCloud<dim> &cloud);

    NodeConditions<dim>      &conditions;
    unsigned int              walls       = 0; ///< that let go, bits
    unsigned int              phases      = 0; ///< that may go, bits
    unsigned int              corrections = 0; ///< in this step
    std::vector<unsigned int> released, kept;  ///< walls by cloud node, bits
    Vector                    kept_numbers;    ///< kept, for checkpoints
  };
} // namespace selkie
