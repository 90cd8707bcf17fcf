// read_json of this Boost uses its own deprecated placeholders
#define BOOST_BIND_GLOBAL_PLACEHOLDERS

#include <selkie/base/exceptions.h>
#include <selkie/output/files.h>
#include <selkie/output/json.h>
#include <selkie/output/table_file.h>
#include <selkie/study/member_run.h>
#include <selkie/version.h>

#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/ptree.hpp>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <thread>

namespace selkie
{
  namespace
  {
    namespace fs = std::filesystem;

    /// Where timings are repeated, runs of a member go on until they have
    /// taken this together (CPU s), or until there are so many.
    constexpr double       short_run = 2.;
    constexpr unsigned int most_runs = 5;

    /// How a child process ended.
    struct Ended
    {
      int    code = 0;            ///< exit code; 128 + signal if killed
      double cpu = 0, memory = 0; ///< s, MB
      bool   too_long = false;
    };

    /// Starts a program with what it prints in a file, and waits for it.
    Ended
    run_child(const std::vector<std::string> &arguments,
              const std::string              &log,
              const double                    time_limit)
    {
      std::vector<char *> argv;
      for (const auto &argument : arguments)
        argv.push_back(const_cast<char *>(argument.c_str()));
      argv.push_back(nullptr);
      const pid_t child = fork();
      if (child < 0)
        throw OutputError("no process can be started for " + arguments[0]);
      if (child == 0)
        {
          // Members are compared: threads of BLAS would be noise.
          setenv("OMP_NUM_THREADS", "1", 0);
          setenv("OPENBLAS_NUM_THREADS", "1", 0);
          const int file =
            open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
          if (file >= 0)
            {
              dup2(file, STDOUT_FILENO);
              dup2(file, STDERR_FILENO);
            }
          execvp(argv[0], argv.data());
          _exit(127);
        }
      const auto start = std::chrono::steady_clock::now();
      Ended      ended;
      rusage     usage{};
      int        status = 0;
      while (wait4(child, &status, WNOHANG, &usage) == 0)
        {
          const std::chrono::duration<double> spent =
            std::chrono::steady_clock::now() - start;
          if (time_limit > 0. && spent.count() > time_limit && !ended.too_long)
            {
              ended.too_long = true;
              kill(child, SIGTERM);
            }
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
      ended.code =
        WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      const auto seconds = [](const timeval &t) {
        return t.tv_sec + 1e-6 * t.tv_usec;
      };
      ended.cpu    = seconds(usage.ru_utime) + seconds(usage.ru_stime);
      ended.memory = usage.ru_maxrss / 1024.;
      return ended;
    }

    /// The reason that a run gives for its end: its last lines, without the
    /// place of the checkpoint.
    std::string
    reason(const std::string &log, const Ended &ended)
    {
      if (ended.too_long)
        return "stopped at the study's time limit";
      std::ifstream file(log);
      std::string   line, last, error;
      while (std::getline(file, line))
        {
          const auto start = line.find_first_not_of(' ');
          if (start == std::string::npos)
            continue;
          if (line.find("error: ") != std::string::npos)
            error = line.substr(line.find("error: ") + 7);
          if (line.find("last good state") == std::string::npos)
            last = line.substr(start);
        }
      return "exit code " + std::to_string(ended.code) + ": " +
             (error.empty() ? last : error);
    }

    double
    sum_of(const TableFile &table, const std::string &column)
    {
      const auto *values = table.find(column);
      return values == nullptr
               ? 0.
               : std::accumulate(values->begin(), values->end(), 0.);
    }

    /// Which of timing.csv's rows belong to which phase.
    const std::map<std::string, std::string> &
    phase_of_row()
    {
      static const std::map<std::string, std::string> table = {
        {"supports", "supports"},
        {"projection", "projection"},
        {"newton/residual", "assembly"},
        {"newton/tangent", "assembly"},
        {"newton/linear solve", "solve"},
        {"update", "update"},
        {"output", "output"}};
      return table;
    }

    /// What the files of a finished run say about its cost.
    void
    read_cost(const std::string &folder, MemberResult &result)
    {
      boost::property_tree::ptree summary;
      boost::property_tree::read_json(folder + "/summary.json", summary);
      result.points   = summary.get<double>("points");
      result.unknowns = summary.get<double>("unknowns");
      result.steps    = summary.get<double>("steps");
      result.wall     = summary.get<double>("wall time (s)");

      const TableFile statistics = read_table(folder + "/statistics.csv");
      result.newton              = sum_of(statistics, "newton iterations");
      result.linear              = sum_of(statistics, "linear iterations");
      result.lambda = sum_of(statistics, "mean lambda iterations") /
                      std::max(1., result.steps);
      for (const char *name : {"energy balance (J)", "energy balance (J/m)"})
        if (const auto *balance = statistics.find(name))
          result.balance = balance->back();

      // timing.csv has names in its first column: not a table of numbers.
      std::ifstream timing(folder + "/timing.csv");
      std::string   line;
      std::getline(timing, line);
      double total = 0., sum = 0.;
      while (std::getline(timing, line))
        {
          std::istringstream row(line);
          std::string        path, calls, wall, cpu;
          std::getline(row, path, ',');
          std::getline(row, calls, ',');
          std::getline(row, wall, ',');
          std::getline(row, cpu, ',');
          if (path == "total")
            total = std::stod(cpu);
          const auto phase = phase_of_row().find(path);
          if (phase == phase_of_row().end())
            continue;
          result.phases[phase->second] += std::stod(cpu);
          sum += std::stod(cpu);
        }
      result.phases["other"] = total - sum;
      result.cpu             = total; // without the start of the program
    }

    /// What identifies a run: the same text, the same run. A scene that was
    /// edited or another build of the program is another run.
    std::string
    key(const Study &study, const Settings &settings)
    {
      std::string text =
        "selkie " SELKIE_GIT_HASH ", " + study.scene + " (text " +
        std::to_string(std::hash<std::string>()(read_text(study.scene))) +
        "), ranks " + std::to_string(study.ranks);
      for (const auto &setting : settings)
        text += ", " + setting;
      return text;
    }

    void
    write_result(const std::string  &path,
                 const std::string  &key,
                 const MemberResult &result)
    {
      JsonObject json, phases;
      json.add("run", key);
      json.add("failure", result.failure);
      json.add("wall", result.wall);
      json.add("cpu", result.cpu);
      json.add("memory", result.memory);
      json.add("points", result.points);
      json.add("unknowns", result.unknowns);
      json.add("steps", result.steps);
      json.add("newton", result.newton);
      json.add("linear", result.linear);
      json.add("lambda", result.lambda);
      json.add("balance", result.balance);
      json.add("timed again", result.timed_again);
      for (const auto &[phase, seconds] : result.phases)
        phases.add(phase, seconds);
      json.add("phases", phases);
      // Renamed when it is whole: a study that is killed leaves no half result.
      json.write(path + ".part");
      fs::rename(path + ".part", path);
    }

    /// Whether the file holds the result of this run.
    bool
    read_result(const std::string &path,
                const std::string &key,
                MemberResult      &result)
    {
      if (!fs::exists(path))
        return false;
      boost::property_tree::ptree json;
      boost::property_tree::read_json(path, json);
      if (json.get<std::string>("run") != key)
        return false;
      result.failure     = json.get<std::string>("failure");
      result.wall        = json.get<double>("wall");
      result.cpu         = json.get<double>("cpu");
      result.memory      = json.get<double>("memory");
      result.points      = json.get<double>("points");
      result.unknowns    = json.get<double>("unknowns");
      result.steps       = json.get<double>("steps");
      result.newton      = json.get<double>("newton");
      result.linear      = json.get<double>("linear");
      result.lambda      = json.get<double>("lambda");
      result.balance     = json.get<double>("balance");
      result.timed_again = json.get<unsigned int>("timed again", 0);
      for (const auto &[phase, seconds] : json.get_child("phases"))
        result.phases[phase] = seconds.get_value<double>();
      return true;
    }
    std::vector<std::string>
    command_of(const Study       &study,
               const Settings    &settings,
               const std::string &folder,
               const std::string &program)
    {
      std::vector<std::string> command;
      if (study.ranks > 1)
        command = {"mpirun", "-np", std::to_string(study.ranks)};
      for (const std::string &word : {program, std::string("run"), study.scene})
        command.push_back(word);
      for (const auto &setting : settings)
        {
          command.push_back("--set");
          command.push_back(setting);
        }
      command.push_back("--output");
      command.push_back(folder);
      return command;
    }

    /// One run: its files in the folder, what it printed in folder.log.
    MemberResult
    run_once(const Study                    &study,
             const std::vector<std::string> &command,
             const std::string              &folder)
    {
      MemberResult result;
      const Ended ended = run_child(command, folder + ".log", study.time_limit);
      if (ended.code == 1 && !ended.too_long) // the scene itself is wrong
        throw SceneError(study.file + ": " + reason(folder + ".log", ended));
      if (ended.code != 0 || ended.too_long)
        result.failure = reason(folder + ".log", ended);
      else
        read_cost(folder, result);
      if (!result.failure.empty())
        result.cpu = ended.cpu;
      result.memory = ended.memory;
      return result;
    }
  } // namespace


  const std::vector<std::string> &
  study_phases()
  {
    static const std::vector<std::string> phases = {"supports",
                                                    "projection",
                                                    "assembly",
                                                    "solve",
                                                    "update",
                                                    "output",
                                                    "other"};
    return phases;
  }


  MemberResult
  run_member(const Study       &study,
             const Settings    &settings,
             const std::string &folder,
             const std::string &program)
  {
    MemberResult      result;
    const std::string result_file = folder + ".json";
    const std::string text        = key(study, settings);
    if (read_result(result_file, text, result))
      return result;

    fs::create_directories(fs::path(folder).parent_path());
    const auto command = command_of(study, settings, folder, program);
    result             = run_once(study, command, folder);
    // Noise only ever adds to a short run's time: the fastest of a few counts.
    double spent = result.cpu;
    for (unsigned int runs = 1;
         study.repetitions > 1 && result.failure.empty() && runs < most_runs &&
         spent < short_run;
         ++runs)
      {
        const MemberResult again = run_once(study, command, folder);
        spent += again.cpu;
        if (again.failure.empty() && again.cpu < result.cpu)
          result = again;
      }
    write_result(result_file, text, result);
    return result;
  }


  MemberResult
  time_again(const Study       &study,
             const Settings    &settings,
             const std::string &folder,
             const std::string &program)
  {
    // Files of its own: a study that is killed meanwhile keeps the others.
    const std::string  files = folder + "_timed";
    const MemberResult again =
      run_once(study, command_of(study, settings, files, program), files);
    fs::remove_all(files);
    fs::remove(files + ".log");
    MemberResult       result = run_member(study, settings, folder, program);
    const unsigned int times  = result.timed_again + 1;
    if (again.failure.empty() && again.cpu < result.cpu)
      result = again;
    result.timed_again = times;
    write_result(folder + ".json", key(study, settings), result);
    return result;
  }
} // namespace selkie
