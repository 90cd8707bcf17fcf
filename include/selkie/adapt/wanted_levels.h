#pragma once

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/boost_adaptors/bounding_box.h>
#include <deal.II/numerics/rtree.h>

#include <memory>
#include <vector>

namespace selkie
{
  /// Where the mesh should have cells of which level: boxes with a level each;
  /// where they overlap the finer one counts.
  template <int dim>
  class WantedLevels
  {
  public:
    struct Part
    {
      dealii::BoundingBox<dim> box;
      unsigned int             level;
    };

    /// @param parts of this rank; afterwards every rank knows those of all.
    /// Collective.
    WantedLevels(const std::vector<Part> &parts, const MPI_Comm comm);

    /// The finest level that is wanted in the interior of a box, or 0.
    unsigned int
    level(const dealii::BoundingBox<dim> &box) const;

  private:
    using Entry = std::pair<dealii::BoundingBox<dim>, unsigned int>;
    dealii::RTree<Entry> tree;
  };
} // namespace selkie
