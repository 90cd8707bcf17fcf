#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/shape/occupancy.h>
#include <selkie/shape/support_table.h>

namespace selkie
{
  /**
   * Adds a patch for every vertex at which matter of two layers has active
   * nodes: bodies that do not share nodes meet there. Its two nodes a and b,
   * of the lower and the upper layer, have one "point" with
   *
   *   N = (1, -1),   G = (n, -n)
   *
   * so that sum N_i v_i is the jump of a velocity and sum v_i . G_i the speed
   * of approach. n is the unit normal from a's matter to b's, the difference
   * of the layers' volume gradients sum_p V_p grad N (Bardenhagen,
   * Brackbill & Sulsky, CMAME 187, 2000). The point's mass is the reduced mass
   * m_a m_b / (m_a + m_b), its x the vertex, and its area the gap between the
   * surfaces (m; negative where they overlap): the distance along n between
   * the farthest material points of either layer in the cells around the
   * vertex, less half of their sizes.
   *
   * The owner of the nodes makes the patch. Vertices where n is not defined
   * have none. Call it when the table has the material points. Collective.
   */
  template <int dim>
  void
  add_contact_pairs(const NodeCloud<dim> &cloud,
                    const Occupancy<dim> &occupancy,
                    SupportTable<dim>    &table);

  /// Takes them out again: contact stops an approach within a step, a blow, and
  /// is no force to start with.
  template <int dim>
  void
  remove_contact_pairs(SupportTable<dim> &table);
} // namespace selkie
