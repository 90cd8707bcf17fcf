#include <selkie/adapt/wanted_levels.h>

#include <algorithm>
#include <numeric>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Lower and upper corner and level, as numbers to send.
    template <int dim>
    std::vector<double>
    pack(const std::vector<typename WantedLevels<dim>::Part> &parts)
    {
      std::vector<double> numbers;
      numbers.reserve(parts.size() * (2 * dim + 1));
      for (const auto &part : parts)
        {
          const auto &[lower, upper] = part.box.get_boundary_points();
          numbers.insert(numbers.end(), lower.begin_raw(), lower.end_raw());
          numbers.insert(numbers.end(), upper.begin_raw(), upper.end_raw());
          numbers.push_back(part.level);
        }
      return numbers;
    }

    /// The numbers of all ranks, in their order. MPI's own collective:
    /// deal.II's all_gather() compresses, which takes ten times as long.
    std::vector<double>
    gather(const std::vector<double> &mine, const MPI_Comm comm)
    {
      const int        n      = mine.size();
      const auto       counts = Utilities::MPI::all_gather(comm, n);
      std::vector<int> begins(counts.size());
      std::partial_sum(counts.begin(), counts.end() - 1, begins.begin() + 1);
      std::vector<double> all(begins.back() + counts.back());
      const int           error = MPI_Allgatherv(mine.data(),
                                       n,
                                       MPI_DOUBLE,
                                       all.data(),
                                       counts.data(),
                                       begins.data(),
                                       MPI_DOUBLE,
                                       comm);
      AssertThrowMPI(error);
      return all;
    }
  } // namespace


  template <int dim>
  WantedLevels<dim>::WantedLevels(const std::vector<Part> &parts,
                                  const MPI_Comm           comm)
  {
    std::vector<Entry> entries;
    const auto         numbers = gather(pack<dim>(parts), comm);
    for (auto number = numbers.begin(); number != numbers.end();)
      {
        Point<dim> lower, upper;
        for (Point<dim> *corner : {&lower, &upper})
          for (unsigned int d = 0; d < dim; ++d)
            (*corner)[d] = *number++;
        const auto level = static_cast<unsigned int>(*number++);
        entries.emplace_back(BoundingBox<dim>({lower, upper}), level);
      }
    tree = pack_rtree(entries);
  }


  template <int dim>
  unsigned int
  WantedLevels<dim>::level(const BoundingBox<dim> &box) const
  {
    namespace bgi = boost::geometry::index;
    // Faces that only touch do not count, whatever round-off says.
    const double inset  = 1e-6 * box.side_length(0);
    auto [lower, upper] = box.get_boundary_points();
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] += inset;
        upper[d] -= inset;
      }
    unsigned int finest = 0;
    for (auto entry =
           tree.qbegin(bgi::intersects(BoundingBox<dim>({lower, upper})));
         entry != tree.qend();
         ++entry)
      finest = std::max(finest, entry->second);
    return finest;
  }


  template class WantedLevels<2>;
  template class WantedLevels<3>;
} // namespace selkie
