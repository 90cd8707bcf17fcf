#include <selkie/output/compare_fields.h>
#include <selkie/output/point_sampler.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace selkie
{
  namespace
  {
    /// A field that is compared, and the numbers 0 and `rest` that it consists
    /// of where matter is at rest or does not have it.
    struct ComparedField
    {
      const char *name;
      double      rest;
    };

    const std::array<ComparedField, 6> compared_fields = {
      {{"displacement", 0.},
       {"velocity", 0.},
       {"pressure", 0.},
       {"deformation gradient", 1.},
       {"volume ratio", 1.},
       {"Cauchy stress", 0.}}};

    /// The time between two pictures, 0 if there is only one.
    double
    median_interval(const std::vector<double> &times)
    {
      std::vector<double> steps;
      for (std::size_t i = 1; i < times.size(); ++i)
        steps.push_back(times[i] - times[i - 1]);
      if (steps.empty())
        return 0.;
      std::nth_element(steps.begin(),
                       steps.begin() + steps.size() / 2,
                       steps.end());
      return steps[steps.size() / 2];
    }

    /// The points of a body at their reference position, or where they are.
    template <int dim>
    std::vector<dealii::Point<dim>>
    places_of(const BodyPoints &body, const bool reference)
    {
      const PointField *const X =
        reference ? body.data->find("reference position") : nullptr;
      std::vector<dealii::Point<dim>> places;
      for (const std::size_t p : body.points)
        {
          dealii::Point<dim> place;
          for (unsigned int d = 0; d < dim; ++d)
            place[d] = X ? (*X)(p, d) : body.data->positions[p][d];
          places.push_back(place);
        }
      return places;
    }

    template <int dim>
    using Stencils = std::vector<typename PointSampler<dim>::Stencil>;

    template <int dim>
    Stencils<dim>
    stencils_between(const BodyPoints &a, const BodyPoints &b)
    {
      const bool reference = a.data->find("reference position") &&
                             b.data->find("reference position");
      const PointSampler<dim> sampler(places_of<dim>(b, reference));
      Stencils<dim>           stencils;
      for (const auto &place : places_of<dim>(a, reference))
        stencils.push_back(sampler.stencil(place));
      return stencils;
    }

    bool
    consists_of(const PointField &field, const BodyPoints &body, double rest)
    {
      for (const std::size_t p : body.points)
        for (unsigned int c = 0; c < field.n_components; ++c)
          if (field(p, c) != 0. && field(p, c) != rest)
            return false;
      return true;
    }

    template <int dim>
    DifferenceSums
    field_sums(const PointField    &field_a,
               const PointField    &field_b,
               const BodyPoints    &a,
               const BodyPoints    &b,
               const Stencils<dim> &stencils,
               const double         time)
    {
      const PointField *const volume = a.data->find("reference volume");
      DifferenceSums          sums;
      for (std::size_t i = 0; i < a.points.size(); ++i)
        {
          const std::size_t p           = a.points[i];
          double            difference2 = 0, value2 = 0;
          for (unsigned int c = 0; c < field_a.n_components; ++c)
            {
              double value_b = 0;
              for (const auto &[j, share] : stencils[i])
                value_b += share * field_b(b.points[j], c);
              const double value_a = field_a(p, c);
              difference2 += (value_a - value_b) * (value_a - value_b);
              value2 += value_a * value_a;
            }
          sums.add(volume ? (*volume)(p) : 1.,
                   std::sqrt(difference2),
                   std::sqrt(value2),
                   time);
        }
      return sums;
    }

    /// The points of a body, by its number in the run.
    BodyPoints
    points_of_body(const PointData &data, const std::size_t body)
    {
      BodyPoints              result{&data, {}};
      const PointField *const bodies = data.find("body");
      for (std::size_t p = 0; bodies && p < data.positions.size(); ++p)
        if ((*bodies)(p) == static_cast<double>(body))
          result.points.push_back(p);
      return result;
    }

    /// All times of a quantity of a body.
    struct FieldHistory
    {
      std::vector<Difference> rows;
      DifferenceSums          sums;
      bool                    varies = false;
    };

    void
    append_time(const std::string         &source,
                const double               time,
                const FieldSums           &of_time,
                std::vector<FieldHistory> &histories)
    {
      auto history =
        std::find_if(histories.begin(),
                     histories.end(),
                     [&](const FieldHistory &h) {
                       return h.rows.front().source == source &&
                              h.rows.front().quantity == of_time.quantity;
                     });
      if (history == histories.end())
        history = histories.insert(history, FieldHistory());
      history->rows.push_back(of_time.sums.result(source, of_time.quantity));
      history->rows.back().time = time;
      history->sums.add(of_time.sums);
      history->varies |= of_time.varies;
    }

    /// Where the fields of two times differ, body by body.
    template <int dim>
    void
    compare_pictures(const RunFolder           &a,
                     const RunFolder           &b,
                     const PointData           &data_a,
                     const PointData           &data_b,
                     const double               time,
                     std::vector<FieldHistory> &histories)
    {
      for (std::size_t body = 0; body < a.bodies.size(); ++body)
        {
          const auto same =
            std::find(b.bodies.begin(), b.bodies.end(), a.bodies[body]);
          const BodyPoints in_a = points_of_body(data_a, body);
          const BodyPoints in_b =
            points_of_body(data_b, same - b.bodies.begin());
          if (in_a.points.empty() || in_b.points.empty())
            continue;
          for (const FieldSums &sums : compare_body<dim>(in_a, in_b, time))
            append_time("body " + a.bodies[body], time, sums, histories);
        }
    }

    std::vector<double>
    first_of(const std::vector<std::pair<double, std::string>> &pictures)
    {
      std::vector<double> times;
      for (const auto &[time, file] : pictures)
        times.push_back(time);
      return times;
    }
  } // namespace


  TimePairs
  pair_times(const std::vector<double> &a, const std::vector<double> &b)
  {
    const double reach =
      0.5 * std::min(median_interval(a), median_interval(b)) + 1e-12;
    TimePairs pairs;
    for (std::size_t i = 0; i < a.size(); ++i)
      {
        const auto nearest =
          std::min_element(b.begin(), b.end(), [&](double s, double t) {
            return std::abs(s - a[i]) < std::abs(t - a[i]);
          });
        if (nearest != b.end() && std::abs(*nearest - a[i]) <= reach)
          pairs.emplace_back(i, nearest - b.begin());
      }
    return pairs;
  }


  template <int dim>
  std::vector<FieldSums>
  compare_body(const BodyPoints &a, const BodyPoints &b, const double time)
  {
    const Stencils<dim>    stencils = stencils_between<dim>(a, b);
    std::vector<FieldSums> result;
    for (const auto &[name, rest] : compared_fields)
      {
        const PointField *const field_a = a.data->find(name);
        const PointField *const field_b = b.data->find(name);
        if (!field_a || !field_b ||
            field_a->n_components != field_b->n_components ||
            field_a->unit != field_b->unit)
          continue;
        FieldSums sums;
        sums.quantity = field_a->unit.empty()
                          ? std::string(name)
                          : std::string(name) + " (" + field_a->unit + ')';
        sums.sums = field_sums<dim>(*field_a, *field_b, a, b, stencils, time);
        sums.varies =
          !consists_of(*field_a, a, rest) || !consists_of(*field_b, b, rest);
        result.push_back(sums);
      }
    return result;
  }


  template <int dim>
  std::vector<Difference>
  compare_fields(const RunFolder &a, const RunFolder &b)
  {
    const auto                pictures_a = read_pvd(a.path + "/particles.pvd");
    const auto                pictures_b = read_pvd(b.path + "/particles.pvd");
    std::vector<FieldHistory> histories;
    for (const auto &[i, j] :
         pair_times(first_of(pictures_a), first_of(pictures_b)))
      compare_pictures<dim>(a,
                            b,
                            read_points(pictures_a[i].second),
                            read_points(pictures_b[j].second),
                            pictures_a[i].first,
                            histories);

    std::vector<Difference> differences;
    for (const FieldHistory &history : histories)
      if (history.varies)
        {
          differences.insert(differences.end(),
                             history.rows.begin(),
                             history.rows.end());
          const Difference &any = history.rows.front();
          differences.push_back(history.sums.result(any.source, any.quantity));
        }
    return differences;
  }


#define INSTANTIATE(dim)                                                  \
  template std::vector<FieldSums>  compare_body<dim>(const BodyPoints &,  \
                                                    const BodyPoints &,  \
                                                    const double);       \
  template std::vector<Difference> compare_fields<dim>(const RunFolder &, \
                                                       const RunFolder &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
