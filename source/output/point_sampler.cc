#include <selkie/output/point_sampler.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <iterator>

namespace selkie
{
  namespace
  {
    /// A weight, and the place of a point as seen from where it is sampled, in
    /// units of the farthest point's distance.
    template <int dim>
    struct Sample
    {
      double                 weight;
      dealii::Tensor<1, dim> d;
    };

    /// Shares of weighted points in the value of their linear fit at d = 0;
    /// empty if they do not fix a linear function.
    template <int dim>
    std::vector<double>
    shares_of(const std::vector<Sample<dim>> &samples)
    {
      double                 sum = 0;
      dealii::Tensor<1, dim> mean;
      for (const auto &[weight, d] : samples)
        {
          sum += weight;
          mean += weight * d;
        }
      mean /= sum;
      dealii::SymmetricTensor<2, dim> moments;
      for (const auto &[weight, d] : samples)
        moments +=
          weight * symmetrize(dealii::outer_product(d - mean, d - mean));

      const auto lambda = dealii::eigenvalues(moments); // descending
      if (!(lambda[dim - 1] > 1e-6 * lambda[0]))
        return {};
      const dealii::Tensor<1, dim> slope = dealii::invert(moments) * mean;
      std::vector<double>          shares;
      for (const auto &[weight, d] : samples)
        shares.push_back(weight * (1. / sum - slope * (d - mean)));
      return shares;
    }
  } // namespace


  template <int dim>
  PointSampler<dim>::PointSampler(const std::vector<dealii::Point<dim>> &points)
  {
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < points.size(); ++i)
      entries.emplace_back(points[i], i);
    tree = dealii::pack_rtree(entries);
  }


  template <int dim>
  typename PointSampler<dim>::Stencil
  PointSampler<dim>::stencil(const dealii::Point<dim> &x) const
  {
    namespace bgi = boost::geometry::index;
    std::vector<Entry> near;
    tree.query(bgi::nearest(x, n_nearest), std::back_inserter(near));
    // The tree gives them in no order; ours does not depend on its making.
    std::sort(near.begin(), near.end(), [&](const Entry &a, const Entry &b) {
      return std::make_pair(a.first.distance_square(x), a.second) <
             std::make_pair(b.first.distance_square(x), b.second);
    });

    const double             reach = near.back().first.distance(x);
    std::vector<Sample<dim>> samples;
    if (reach > 0.)
      for (const Entry &entry : near)
        {
          const dealii::Tensor<1, dim> d = (entry.first - x) / reach;
          // Bounded, where the point is at x itself.
          samples.push_back({1. / (d.norm_square() + 1e-12), d});
        }
    const auto shares =
      samples.empty() ? std::vector<double>() : shares_of(samples);
    if (shares.empty())
      return {{near.front().second, 1.}};
    Stencil stencil;
    for (std::size_t i = 0; i < near.size(); ++i)
      stencil.emplace_back(near[i].second, shares[i]);
    return stencil;
  }


  template class PointSampler<2>;
  template class PointSampler<3>;
} // namespace selkie
