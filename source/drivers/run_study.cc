#include <selkie/base/exceptions.h>
#include <selkie/base/text.h>
#include <selkie/drivers/run_study.h>
#include <selkie/output/files.h>
#include <selkie/output/json.h>
#include <selkie/scene/read_scene.h>
#include <selkie/study/convergence.h>
#include <selkie/study/measure.h>
#include <selkie/study/member_run.h>
#include <selkie/version.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <set>
#include <sstream>

namespace selkie
{
  namespace
  {
    namespace fs = std::filesystem;

    /// The errors at which the costs of the series are compared.
    constexpr double wanted_errors[] = {0.1, 0.03, 0.01, 3e-3, 1e-3, 1e-4};

    /// How often a member whose timings contradict another's is timed again.
    constexpr unsigned int often_enough = 5;

    double
    median(std::vector<double> values)
    {
      std::sort(values.begin(), values.end());
      const std::size_t n = values.size();
      return n == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : 0.5 * (values[(n - 1) / 2] + values[n / 2]);
    }

    /// A member with all that its repetitions gave.
    struct Row
    {
      const StudyMember *member;
      MemberResult       result; ///< of the first repetition
      // of each repetition
      std::vector<double>       wall, cpu;
      std::vector<unsigned int> timed_again;

      /// The member was timed again: what it gave is what it was.
      void
      replace(const unsigned int repetition, MemberResult timed)
      {
        wall[repetition]        = timed.wall;
        cpu[repetition]         = timed.cpu;
        timed_again[repetition] = timed.timed_again;
        if (repetition > 0)
          return;
        timed.quantity = result.quantity;
        timed.error    = result.error;
        result         = timed;
      }
    };

    std::string
    folder_of(const Study       &study,
              const StudyMember &member,
              const unsigned int repetition)
    {
      return study.directory + "/" + member.name +
             (repetition == 0 ? "" : "_again_" + std::to_string(repetition));
    }

    std::string
    cell(const double value)
    {
      if (!std::isfinite(value))
        return "nan";
      std::ostringstream out;
      out.precision(10);
      out << value;
      return out.str();
    }

    std::string
    quoted(std::string text)
    {
      std::replace(text.begin(), text.end(), '"', '\'');
      return '"' + text + '"';
    }

    std::string
    joined(const Settings &settings, const std::string &separator)
    {
      std::string text;
      for (const auto &setting : settings)
        text += (text.empty() ? "" : separator) + setting;
      return text;
    }

    void
    write_csv(const Study &study, const std::vector<Row> &rows)
    {
      write_file(study.directory + "/study.csv", [&](std::ostream &file) {
        file << "series,member,settings,failure,quantity,error,wall (s),"
                "cpu (s)";
        for (const auto &phase : study_phases())
          file << "," << phase << " (s)";
        file << ",memory (MB),points,unknowns,steps,newton iterations,linear "
                "iterations,mean lambda iterations,energy balance\n";
        for (const Row &row : rows)
          {
            const MemberResult &r = row.result;
            file << row.member->series << ',' << row.member->name << ','
                 << quoted(joined(row.member->settings, " & ")) << ','
                 << quoted(r.failure) << ',' << cell(r.quantity) << ','
                 << cell(r.error) << ',' << cell(median(row.wall)) << ','
                 << cell(median(row.cpu));
            for (const auto &phase : study_phases())
              {
                const auto found = r.phases.find(phase);
                file << ','
                     << (found == r.phases.end() ? "nan" : cell(found->second));
              }
            for (const double value : {r.memory,
                                       r.points,
                                       r.unknowns,
                                       r.steps,
                                       r.newton,
                                       r.linear,
                                       r.lambda,
                                       r.balance})
              file << ',' << cell(value);
            file << '\n';
          }
      });
    }

    /// The names of the series, in the study's order.
    std::vector<std::string>
    series_of(const Study &study)
    {
      std::vector<std::string> names;
      for (const auto &member : study.members)
        if (names.empty() || names.back() != member.series)
          names.push_back(member.series);
      return names;
    }

    /// The members of a series that were run to their end; all if no name.
    /// The size is that of a cell relative to the domain, unknowns^(-1/dim),
    /// or of the step if the unknowns are the same.
    std::vector<CostAndError>
    points_of(const std::vector<Row> &rows,
              const unsigned int      dim,
              const std::string      &series = "")
    {
      std::vector<CostAndError> points;
      std::vector<double>       steps;
      for (const Row &row : rows)
        if (row.result.failure.empty() && std::isfinite(row.result.error) &&
            row.result.error > 0. &&
            (series.empty() || row.member->series == series))
          {
            points.push_back({std::pow(row.result.unknowns, -1. / dim),
                              median(row.cpu),
                              row.result.error});
            steps.push_back(1. / row.result.steps);
          }
      if (std::all_of(points.begin(), points.end(), [&](const auto &point) {
            return point.size == points[0].size;
          }))
        for (unsigned int i = 0; i < points.size(); ++i)
          points[i].size = steps[i];
      return points;
    }

    /// The cheapest member with at most this error, or nullptr.
    const Row *
    cheapest(const std::vector<Row> &rows, const double error)
    {
      const Row *best = nullptr;
      for (const Row &row : rows)
        if (row.result.failure.empty() && row.result.error <= error &&
            (best == nullptr || median(row.cpu) < median(best->cpu)))
          best = &row;
      return best;
    }

    /// Settings as a piece of a .prm.
    std::string
    as_prm(const Settings &settings)
    {
      std::string text;
      for (const auto &setting : settings)
        {
          const auto  equals = setting.find('=');
          std::string path   = setting.substr(0, equals), ends;
          std::string indent;
          for (auto slash = path.find('/'); slash != std::string::npos;
               slash      = path.find('/'))
            {
                   text += indent + "subsection " + path.substr(0, slash) + "\n";
                   ends = indent + "end\n" + ends;
                   indent += "  ";
                   path = path.substr(slash + 1);
            }
          text += indent + "set " + path + " = " + setting.substr(equals + 1) +
                  "\n" + ends;
        }
      return text;
    }

    void
    write_cheapest(const Study &study, const std::vector<Row> &rows)
    {
      write_file(study.directory + "/cheapest.prm", [&](std::ostream &file) {
        file << "# The cheapest settings of the study that reach an error; for "
                "a .prm of\n# the scene "
             << study.scene << "\n";
        const Row *last = nullptr;
        for (const double error : wanted_errors)
          if (const Row *row = cheapest(rows, error); row != nullptr)
            {
              file << format("\n# error %g %%: %s, error %.3g %%, CPU %.3g s\n",
                             100. * error,
                             row->member->name.c_str(),
                             100. * row->result.error,
                             median(row->cpu));
              file << (row == last ? "# (the same as above)\n"
                                   : as_prm(row->member->settings));
              last = row;
            }
      });
    }

    /// "1 % error: fem 3.1 s, lme 7.4 s, mpm not reached", for each error.
    std::vector<std::string>
    readings(const Study            &study,
             const std::vector<Row> &rows,
             const unsigned int      dim)
    {
      std::vector<std::string> lines;
      for (const double error : wanted_errors)
        {
          std::string line    = format("%g %% error:", 100. * error);
          bool        reached = false;
          for (const auto &series : series_of(study))
            {
              const double time =
                time_to_reach(points_of(rows, dim, series), error);
              reached = reached || std::isfinite(time);
              line +=
                (line.back() == ':' ? " " : ", ") + series + " " +
                (std::isfinite(time) ? format("%.3g s", time) : "not reached");
            }
          if (reached)
            lines.push_back(line);
        }
      return lines;
    }

    std::vector<std::string>
    order_lines(const Study            &study,
                const std::vector<Row> &rows,
                const unsigned int      dim)
    {
      std::vector<std::string> lines;
      for (const auto &series : series_of(study))
        {
          const auto points = points_of(rows, dim, series);
          const auto orders = observed_orders(points);
          if (!std::all_of(orders.begin(), orders.end(), [](const double p) {
                return std::isfinite(p);
              }))
            continue; // not a series of meshes or steps, one finer than another
          std::string line = series + ": observed orders";
          for (const double order : orders)
            line += format(" %.2f", order);
          const double fit = fitted_order(points);
          line += std::isfinite(fit) ? format("; fit %.2f", fit)
                                     : "; no asymptotic range";
          lines.push_back(line);
        }
      return lines;
    }

    void
    write_json(const Study            &study,
               const std::vector<Row> &rows,
               const unsigned int      dim)
    {
      JsonObject json;
      json.add("title", study.title);
      json.add("study", study.file);
      json.add("scene", study.scene);
      json.add("quantity",
               (study.quantity.probe.empty() ? ""
                                             : study.quantity.probe + ": ") +
                 study.quantity.column);
      json.add("ranks", study.ranks);
      json.add("repetitions", study.repetitions);
      json.add("time to error (CPU s)", readings(study, rows, dim));
      json.add("orders", order_lines(study, rows, dim));
      const auto               front = pareto_front(points_of(rows, dim));
      std::vector<std::string> best;
      unsigned int             i = 0;
      for (const Row &row : rows)
        if (row.result.failure.empty() && std::isfinite(row.result.error) &&
            row.result.error > 0. && front[i++])
          best.push_back(row.member->name);
      json.add("pareto front", best);
      json.write(study.directory + "/study.json");
    }

    void
    print_table(const std::vector<Row> &rows, std::ostream &out)
    {
      out << format("%-22s %12s %11s %9s %9s %9s %7s %8s\n",
                    "member",
                    "quantity",
                    "error",
                    "CPU (s)",
                    "wall (s)",
                    "unknowns",
                    "steps",
                    "MB");
      for (const Row &row : rows)
        {
          const MemberResult &r = row.result;
          if (!r.failure.empty())
            out << format("%-22s failed: ", row.member->name.c_str())
                << r.failure << '\n';
          else
            out << format("%-22s %12.6g %11.4g %9.3g %9.3g %9.0f %7.0f %8.0f\n",
                          row.member->name.c_str(),
                          r.quantity,
                          r.error,
                          median(row.cpu),
                          median(row.wall),
                          r.unknowns,
                          r.steps,
                          r.memory);
        }
    }

    /// Runs the reference, if the study has one that is a run.
    std::string
    reference_folder(const Study &study, const std::string &program)
    {
      if (study.quantity.run.empty())
        return "";
      const std::string folder = study.directory + "/reference";
      std::cout << "reference  " << std::flush;
      const MemberResult result =
        run_member(study, study.quantity.run, folder, program);
      std::cout << format("%.3g s\n", result.cpu) << std::flush;
      if (!result.failure.empty())
        throw NumericalFailure("the study's reference run failed: " +
                               result.failure);
      return folder;
    }

    /// The members whose costs differ by more than 20 % from those of another,
    /// but are in another order in one of the repetitions.
    std::vector<Row *>
    contradictory(std::vector<Row> &rows, const unsigned int repetitions)
    {
      std::set<Row *> found;
      for (Row &a : rows)
        for (Row &b : rows)
          if (a.cpu.size() == repetitions && b.cpu.size() == repetitions &&
              median(a.cpu) > 1.2 * median(b.cpu))
            for (unsigned int k = 0; k < repetitions; ++k)
              if (a.cpu[k] <= b.cpu[k])
                found.insert({&a, &b});
      return {found.begin(), found.end()};
    }

    /// Times contradictory members again until they agree, or often enough (in
    /// all starts of the study together): the fastest run of each repetition
    /// counts.
    void
    settle_timings(const Study       &study,
                   const std::string &program,
                   std::vector<Row>  &rows)
    {
      bool settled = false;
      while (!settled)
        {
          settled = true;
          for (Row *row : contradictory(rows, study.repetitions))
            for (unsigned int k = 0; k < study.repetitions; ++k)
              if (row->timed_again[k] < often_enough)
                {
                  const auto result =
                    time_again(study,
                               row->member->settings,
                               folder_of(study, *row->member, k),
                               program);
                  std::cout
                    << format("%-10s %.3g s (again: timings contradict)",
                              row->member->name.c_str(),
                              result.cpu)
                    << std::endl;
                  row->replace(k, result);
                  settled = false;
                }
        }
    }

    void
    write_all(const Study            &study,
              const std::vector<Row> &rows,
              const unsigned int      dim)
    {
      write_csv(study, rows);
      write_cheapest(study, rows);
      write_json(study, rows, dim);
    }

    /// The plot is matplotlib's job; without it the tables stand.
    void
    plot(const Study &study)
    {
      const std::string script =
        std::string(SELKIE_SCRIPTS_DIR) + "/plots/study";
      const std::string command = "'" + script + "' '" + study.directory + "'";
      if (std::system((command + " 2>/dev/null").c_str()) != 0)
        std::cout << "No plot: it needs python3 with matplotlib (Debian: "
                     "apt-get install python3-matplotlib); then\n  "
                  << command << '\n';
    }
  } // namespace


  int
  run_study(const Study &study, const std::string &program)
  {
    const unsigned int dim =
      study.directions > 0 ? study.directions : read_dimension(study.scene, {});
    fs::create_directories(study.directory);
    std::cout << "Study      " << study.title << ": " << study.members.size()
              << " members, " << study.repetitions << " repetition(s), in "
              << study.directory << '\n';
    const std::string reference = reference_folder(study, program);
    std::vector<Row>  rows;
    for (const auto &member : study.members)
      rows.push_back({&member, MemberResult(), {}, {}, {}});
    // Repetition after repetition, so that a busy minute hits all members.
    for (unsigned int k = 0; k < study.repetitions; ++k)
      for (Row &row : rows)
        {
          std::cout << format("%-10s ", row.member->name.c_str()) << std::flush;
          const std::string folder = folder_of(study, *row.member, k);
          MemberResult      result =
            run_member(study, row.member->settings, folder, program);
          std::cout << (result.failure.empty() ? format("%.3g s", result.cpu)
                                               : "failed: " + result.failure)
                    << std::endl;
          if (result.failure.empty())
            {
              row.wall.push_back(result.wall);
              row.cpu.push_back(result.cpu);
              row.timed_again.push_back(result.timed_again);
            }
          if (k > 0)
            continue;
          if (result.failure.empty())
            {
              const Curve curve = read_curve(study.quantity, folder);
              result.quantity   = reduce(curve, study.quantity.reduction);
              result.error      = error_of(curve, study.quantity, reference);
            }
          row.result = result;
          write_all(study, rows, dim);
        }
    settle_timings(study, program, rows);
    write_all(study, rows, dim);
    std::cout << '\n';
    print_table(rows, std::cout);
    for (const auto &lines :
         {readings(study, rows, dim), order_lines(study, rows, dim)})
      {
        std::cout << '\n';
        for (const auto &line : lines)
          std::cout << line << '\n';
      }
    plot(study);
    const bool any = std::any_of(rows.begin(), rows.end(), [](const Row &row) {
      return row.result.failure.empty();
    });
    return any ? 0 : 2;
  }
} // namespace selkie
