#include <selkie/base/exceptions.h>
#include <selkie/output/compare.h>
#include <selkie/output/compare_curves.h>
#include <selkie/output/compare_fields.h>
#include <selkie/output/files.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>

namespace selkie
{
  namespace
  {
    const std::string comparison_header =
      "source,quantity,time (s),relative L2 difference,"
      "largest difference (unit of the quantity),"
      "time of the largest difference (s),"
      "largest value of A (unit of the quantity)";

    std::string
    number_text(const char *format, const double value)
    {
      char text[32];
      std::snprintf(text, sizeof(text), format, value);
      return text;
    }

    /// The files probes/NAME.csv, by name.
    std::vector<std::string>
    probe_names(const RunFolder &run)
    {
      namespace fs = std::filesystem;
      std::vector<std::string> names;
      const fs::path           folder = fs::path(run.path) / "probes";
      if (fs::is_directory(folder))
        for (const auto &entry : fs::directory_iterator(folder))
          if (entry.path().extension() == ".csv")
            names.push_back(entry.path().stem().string());
      std::sort(names.begin(), names.end());
      return names;
    }

    /// Adds the columns of a table that both runs have.
    void
    append_curves(const std::string                              &source,
                  const std::string                              &file,
                  const std::function<bool(const std::string &)> &wanted,
                  Comparison                                     &comparison)
    {
      const auto found =
        compare_curves(source,
                       read_table(comparison.a.path + '/' + file),
                       read_table(comparison.b.path + '/' + file),
                       wanted);
      comparison.differences.insert(comparison.differences.end(),
                                    found.begin(),
                                    found.end());
    }

    void
    append_probes(Comparison &comparison)
    {
      const auto in_b = probe_names(comparison.b);
      for (const std::string &name : probe_names(comparison.a))
        if (std::binary_search(in_b.begin(), in_b.end(), name))
          append_curves(
            "probe " + name,
            "probes/" + name + ".csv",
            [](const std::string &) { return true; },
            comparison);
    }

    void
    append_fields(Comparison &comparison)
    {
      const RunFolder &a = comparison.a, &b = comparison.b;
      for (const RunFolder *run : {&a, &b})
        if (!std::filesystem::exists(run->path + "/particles.pvd"))
          return; // without pictures: Output/Interval is 0
      const auto found =
        a.dimension == 2 ? compare_fields<2>(a, b) : compare_fields<3>(a, b);
      comparison.differences.insert(comparison.differences.end(),
                                    found.begin(),
                                    found.end());
    }

    std::string
    csv_text(const Comparison &comparison)
    {
      std::string text = comparison_header + '\n';
      for (const Difference &d : comparison.differences)
        text += d.source + ',' + d.quantity + ',' +
                (std::isnan(d.time) ? "all" : number_text("%.10g", d.time)) +
                ',' + number_text("%.10g", d.relative_L2) + ',' +
                number_text("%.10g", d.largest) + ',' +
                number_text("%.10g", d.largest_time) + ',' +
                number_text("%.10g", d.scale) + '\n';
      return text;
    }

    /// Whether there is a file that this command did not write.
    bool
    is_of_others(const std::string &path)
    {
      if (!std::filesystem::exists(path))
        return false;
      return read_text(path).compare(0,
                                     comparison_header.size(),
                                     comparison_header) != 0;
    }

    std::string
    described(const RunFolder &run)
    {
      return run.path + " (" + run.approximation + ')' +
             (run.unfinished.empty() ? ""
                                     : "; not finished: " + run.unfinished);
    }

    /// Cells padded to the widest of their column: the first two to the right,
    /// numbers to the left.
    std::string
    aligned(const std::vector<std::vector<std::string>> &rows)
    {
      std::vector<std::size_t> widths(rows.front().size(), 0);
      for (const auto &row : rows)
        for (std::size_t i = 0; i < row.size(); ++i)
          widths[i] = std::max(widths[i], row[i].size());
      std::string text;
      for (const auto &row : rows)
        {
          for (std::size_t i = 0; i < row.size(); ++i)
            {
              const std::string space(widths[i] - row[i].size(), ' ');
              text += i < 2 ? row[i] + space : space + row[i];
              text += i + 1 < row.size() ? "  " : "\n";
            }
        }
      return text;
    }
  } // namespace


  Comparison
  compare_runs(const std::string &folder_a, const std::string &folder_b)
  {
    Comparison       comparison{read_run_folder(folder_a),
                          read_run_folder(folder_b),
                          {}};
    const RunFolder &a = comparison.a, &b = comparison.b;
    if (a.dimension != b.dimension)
      throw SceneError("the runs '" + folder_a + "' (" +
                       std::to_string(a.dimension) + "D) and '" + folder_b +
                       "' (" + std::to_string(b.dimension) +
                       "D) cannot be compared: their dimensions differ");
    append_probes(comparison);
    append_fields(comparison);
    append_curves("statistics", "statistics.csv", is_physical, comparison);
    if (comparison.differences.empty())
      throw SceneError("the runs '" + folder_a + "' and '" + folder_b +
                       "' share nothing that could be compared: no column of "
                       "statistics.csv or of a probe, and no body in "
                       "particles.pvd, at a common time");
    return comparison;
  }


  std::string
  write_comparison(const Comparison &comparison, const std::string &directory)
  {
    namespace fs = std::filesystem;
    const fs::path folder =
      !directory.empty()
        ? fs::path(directory)
        : fs::path(comparison.a.path) / ("compare_" + comparison.b.name);
    const std::string path = (folder / "compare.csv").string();
    try
      {
        if (is_of_others(path))
          throw std::runtime_error("a file of other content is there");
        fs::create_directories(folder);
        write_text(path, csv_text(comparison));
      }
    catch (const std::runtime_error &error)
      {
        throw SceneError("'" + path + "' cannot be written (" + error.what() +
                         "); choose another folder with --output");
      }
    return path;
  }


  std::string
  comparison_table(const Comparison &comparison)
  {
    std::vector<std::vector<std::string>> rows       = {{"source",
                                                         "quantity",
                                                         "relative L2",
                                                         "largest",
                                                         "at t (s)",
                                                         "largest of A"}};
    std::size_t                           n_pictures = 0;
    for (const Difference &d : comparison.differences)
      if (std::isnan(d.time))
        rows.push_back({d.source,
                        d.quantity,
                        number_text("%.3e", d.relative_L2),
                        number_text("%.3e", d.largest),
                        number_text("%.4g", d.largest_time),
                        number_text("%.3e", d.scale)});
      else
        ++n_pictures;
    return "A: " + described(comparison.a) + "\nB: " + described(comparison.b) +
           "\n\n" + aligned(rows) +
           (n_pictures == 0 ? "\nNo fields: the runs have no pictures of a "
                              "body at a common time.\n"
                            : "");
  }
} // namespace selkie
