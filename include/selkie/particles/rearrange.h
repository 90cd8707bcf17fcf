#pragma once

#include <selkie/particles/particle_set.h>

namespace selkie
{
  /// What rearrange() did, on all ranks.
  struct Rearrangement
  {
    unsigned long long split  = 0; ///< points that became 2^dim
    unsigned long long merged = 0; ///< points that went into another
  };

  /**
   * Fits the points to the cells of a mesh that has changed: one that is too
   * large for its cell becomes 2^dim, small ones that share a place of the
   * cell's lattice (that of the seeding) become one.
   *
   * Mass, volume and momentum stay; so does the angular momentum: what a merge
   * takes of it goes into a rigid rotation of the body's points in the cell
   * (only a point left alone in its cell cannot take it up). Energy does not: a
   * merge loses that of the points' motion relative to each other and of the
   * differences in their strain, and gains where the same spin is left to
   * points that lie closer together. The columns are shared out by
   * ParticleFields::Entry::combine; the volume ratio of merged points, J or
   * det F, is that of their volume. Children of a point lie where its lattice
   * cell, deformed by F, has its quarters; new ones get new ids, which do not
   * depend on the partition. Collective.
   */
  template <int dim>
  Rearrangement
  rearrange(ParticleSet<dim> &particles, const bool split, const bool merge);
} // namespace selkie
