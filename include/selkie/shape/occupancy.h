#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>

#include <vector>

namespace selkie
{
  /**
   * Which nodes each phase may use: the corners of the cells that hold points
   * of the phase, on any rank. Without this rule LME tails across an interface
   * drag a stiff solid with the fluid's drift (formulation.md, section 9).
   */
  template <int dim>
  struct Occupancy
  {
    /// Bit p of active[node]: the node belongs to phase p. Cloud numbering.
    std::vector<unsigned int> active;

    /// Whether every existing cell around the node holds fluid and none holds
    /// solid: a cell is full when all its corners are enclosed. Empty when the
    /// scene does not ask for Gauss points in full cells.
    std::vector<bool> enclosed;

    bool
    has_phase(const unsigned int node, const unsigned int phase) const
    {
      return (active[node] >> phase) & 1u;
    }
  };

  /// Collective.
  template <int dim>
  Occupancy<dim>
  find_occupancy(const ParticleSet<dim> &particles,
                 const NodeCloud<dim>   &cloud,
                 const bool              want_enclosed);
} // namespace selkie
