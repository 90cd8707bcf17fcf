#include <selkie/base/exceptions.h>
#include <selkie/base/expression.h>
#include <selkie/output/table_file.h>
#include <selkie/study/measure.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace selkie
{
  namespace
  {
    /// The column called @p name, with or without its unit.
    const std::vector<double> *
    find_column(const TableFile &table, const std::string &name)
    {
      for (unsigned int c = 0; c < table.columns.size(); ++c)
        if (table.columns[c] == name ||
            table.columns[c].rfind(name + " (", 0) == 0)
          return &table.values[c];
      return nullptr;
    }

    double
    rms(const std::vector<double> &values)
    {
      return std::sqrt(
        std::inner_product(values.begin(), values.end(), values.begin(), 0.) /
        values.size());
    }

    /// The reference at the times of a curve, where it is known there.
    Curve
    reference_curve(const Curve         &of,
                    const StudyQuantity &quantity,
                    const std::string   &reference_folder)
    {
      Curve reference;
      if (!quantity.function.empty())
        {
          const Expression function(quantity.function);
          for (const double t : of.times)
            {
              reference.times.push_back(t);
              reference.values.push_back(function.value(dealii::Point<2>(), t));
            }
          return reference;
        }
      Curve known;
      if (quantity.file.empty())
        known = read_curve(quantity, reference_folder);
      else
        {
          const TableFile table = read_table(quantity.file);
          if (table.columns.size() < 2)
            throw SceneError(quantity.file +
                             ": allowed is a table of times and values");
          known = {table.values[0], table.values[1]};
        }
      const double slack = 1e-9 * (known.times.back() - known.times.front());
      for (const double t : of.times)
        if (t >= known.times.front() - slack && t <= known.times.back() + slack)
          {
            reference.times.push_back(t);
            reference.values.push_back(
              interpolate(known.times, known.values, t));
          }
      return reference;
    }
  } // namespace


  Curve
  read_curve(const StudyQuantity &quantity, const std::string &folder)
  {
    const std::string path =
      folder + (quantity.probe.empty() ? "/statistics.csv"
                                       : "/probes/" + quantity.probe + ".csv");
    const TableFile table  = read_table(path);
    const auto     *times  = find_column(table, "time");
    const auto     *values = find_column(table, quantity.column);
    if (times == nullptr || values == nullptr)
      {
        std::string names;
        for (const auto &name : table.columns)
          names += (names.empty() ? "'" : ", '") + name + "'";
        throw SceneError(path + ": there is no column '" + quantity.column +
                         "'; allowed are " + names);
      }
    Curve curve;
    for (unsigned int i = 0; i < times->size(); ++i)
      if (std::isfinite((*values)[i]))
        {
          curve.times.push_back((*times)[i]);
          curve.values.push_back((*values)[i]);
        }
    return curve;
  }


  double
  reduce(const Curve &curve, const Reduction reduction)
  {
    const auto &values = curve.values;
    if (values.empty())
      return std::numeric_limits<double>::quiet_NaN();
    switch (reduction)
      {
        case Reduction::last:
          return values.back();
        case Reduction::largest:
          return *std::max_element(values.begin(), values.end());
        case Reduction::smallest:
          return *std::min_element(values.begin(), values.end());
        case Reduction::mean:
          return std::accumulate(values.begin(), values.end(), 0.) /
                 values.size();
        case Reduction::rms:
          return rms(values);
      }
    return std::numeric_limits<double>::quiet_NaN();
  }


  double
  error_of(const Curve         &curve,
           const StudyQuantity &quantity,
           const std::string   &reference_folder)
  {
    const double number   = reduce(curve, quantity.reduction);
    const auto   relative = [](const double difference, const double exact) {
      return std::abs(exact != 0. ? difference / exact : difference);
    };
    if (quantity.value)
      return relative(number - *quantity.value, *quantity.value);
    if (quantity.function.empty() && quantity.file.empty() &&
        quantity.run.empty())
      return std::abs(number) / quantity.scale;

    const Curve reference = reference_curve(curve, quantity, reference_folder);
    if (quantity.reduction != Reduction::rms)
      {
        const double exact = reduce(reference, quantity.reduction);
        return relative(number - exact, exact);
      }
    std::vector<double> difference;
    for (unsigned int i = 0; i < reference.times.size(); ++i)
      difference.push_back(
        interpolate(curve.times, curve.values, reference.times[i]) -
        reference.values[i]);
    return difference.empty()
             ? std::numeric_limits<double>::quiet_NaN()
             : relative(rms(difference), rms(reference.values));
  }
} // namespace selkie
