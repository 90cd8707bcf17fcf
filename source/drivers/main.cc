#include <selkie/base/exceptions.h>
#include <selkie/drivers/command_line.h>
#include <selkie/drivers/run_study.h>
#include <selkie/drivers/simulation.h>
#include <selkie/output/compare.h>
#include <selkie/scene/read_scene.h>
#include <selkie/version.h>

#include <deal.II/base/mpi.h>

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

namespace
{
  using namespace selkie;

  enum ExitCode
  {
    done              = 0,
    bad_input         = 1,
    numerical_failure = 2
  };


  template <int dim>
  int
  run_or_check(const CommandLine &command_line, const MPI_Comm comm)
  {
    const Scene<dim> scene =
      read_scene<dim>(command_line.file, command_line.overrides);
    if (command_line.command == CommandLine::Command::run)
      return run_scene(scene, comm);
    if (command_line.command == CommandLine::Command::resume)
      return run_scene(scene, comm, true);
    print_plan(scene, comm);
    return done;
  }


  /// Compares two runs, writes what it found and returns the table.
  std::string
  compare(const CommandLine &command_line, const MPI_Comm comm)
  {
    if (dealii::Utilities::MPI::n_mpi_processes(comm) > 1)
      throw SceneError("'compare' runs as one process; leave out mpirun");
    const Comparison comparison =
      compare_runs(command_line.folders[0], command_line.folders[1]);
    const std::string path = write_comparison(comparison, command_line.output);
    return comparison_table(comparison) + "\nWritten to " + path + '\n';
  }


  /// A run that is resumed goes on with the scene that it began with, as its
  /// output folder has it; what may be changed is how it goes on.
  CommandLine
  as_resumed_scene(CommandLine command_line)
  {
    static const std::vector<std::string> allowed = {
      "Title=",
      "Time/",
      "Newton/",
      "Linear solver/",
      "Audit/",
      "Output/Interval=",
      "Output/Mesh=",
      "Output/Checkpoint steps=",
      "Output/Checkpoint minutes="};
    const std::string folder = command_line.file;
    for (const std::string &text : command_line.overrides)
      if (std::none_of(allowed.begin(),
                       allowed.end(),
                       [&text](const std::string &begin) {
                         return text.rfind(begin, 0) == 0;
                       }))
        throw SceneError(
          "--set: " + text.substr(0, text.find('=')) +
          ": a run that is resumed goes on with the scene that it began with; "
          "allowed are parameters of Time, Newton, Linear solver and Audit, "
          "Title, Output/Interval, Output/Mesh and the two of checkpoints");
    if (!std::filesystem::exists(folder + "/parameters.prm"))
      throw SceneError("'" + folder +
                       "' is not the output folder of a run: "
                       "there is no parameters.prm in it");
    command_line.file = folder + "/parameters.prm";
    command_line.overrides.push_back("Output/Directory=" + folder);
    return command_line;
  }


  int
  execute(const std::vector<std::string> &arguments, const MPI_Comm comm)
  {
    using Command = CommandLine::Command;

    CommandLine command_line = parse_command_line(arguments);
    if (command_line.command == Command::resume)
      command_line = as_resumed_scene(command_line);
    const bool is_first = dealii::Utilities::MPI::this_mpi_process(comm) == 0;
    const auto print    = [&](const std::string &text) {
      if (is_first)
        std::cout << text << std::flush;
      return done;
    };
    switch (command_line.command)
      {
        case Command::help:
          return print(help_text());
        case Command::version:
          return print(version_text());
        case Command::compare:
          return print(compare(command_line, comm));
        case Command::parameters:
          return print(parameter_reference(command_line.markdown));
        case Command::run:
        case Command::check:
        case Command::resume:
        case Command::study: // main() has run these
        case Command::report:
          break;
      }
    return read_dimension(command_line.file, command_line.overrides) == 2
             ? run_or_check<2>(command_line, comm)
             : run_or_check<3>(command_line, comm);
  }


  /// A study starts processes that start MPI, and so starts none itself.
  int
  study(const CommandLine &command_line)
  {
    const char *size = std::getenv("OMPI_COMM_WORLD_SIZE");
    if (size != nullptr && std::string(size) != "1")
      throw SceneError("'study' runs as one process and starts others itself "
                       "(Study/Ranks); leave out mpirun");
    return run_study(read_study(command_line.file, command_line.overrides),
                     std::filesystem::read_symlink("/proc/self/exe"));
  }


  /// Pages and their plots are Python's job: scripts/report.
  int
  make_report(const CommandLine &command_line)
  {
    const std::string script = std::string(SELKIE_SCRIPTS_DIR) + "/report";
    std::vector<std::string> words = {script};
    words.insert(words.end(),
                 command_line.folders.begin(),
                 command_line.folders.end());
    if (!command_line.output.empty())
      words.insert(words.end(), {"--output", command_line.output});
    for (const std::string &reference : command_line.references)
      words.insert(words.end(), {"--reference", reference});
    std::vector<char *> arguments;
    for (std::string &word : words)
      arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(script.c_str(), arguments.data());
    throw OutputError("'report' needs " + script + " and python3");
  }


  /// The exit code of a command that must not start MPI, or -1 if the arguments
  /// ask for another.
  int
  without_mpi(const std::vector<std::string> &arguments)
  {
    if (arguments.empty() ||
        (arguments[0] != "study" && arguments[0] != "report"))
      return -1;
    const auto fail = [](const std::exception &error, const ExitCode code) {
      std::cerr << "selkie: error: " << error.what() << std::endl;
      return code;
    };
    try
      {
        const CommandLine command_line = parse_command_line(arguments);
        if (command_line.command == CommandLine::Command::study)
          return study(command_line);
        if (command_line.command == CommandLine::Command::report)
          return make_report(command_line);
        return -1; // --help, --version
      }
    catch (const NumericalFailure &error)
      {
        return fail(error, numerical_failure);
      }
    catch (const std::exception &error)
      {
        return fail(error, bad_input);
      }
  }


  int
  report(const std::string &what, const ExitCode code)
  {
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::cerr << "selkie: error: " << what << std::endl;
    return code;
  }


  /// An error that is not ours need not have happened on all ranks: end the
  /// others too, that they do not wait for ever.
  int
  report_unexpected(const std::string &what)
  {
    std::cerr << "selkie: error: " << what << std::endl;
    if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      MPI_Abort(MPI_COMM_WORLD, numerical_failure);
    return numerical_failure;
  }
} // namespace


// SceneError, OutputError and NumericalFailure are thrown on all ranks alike:
// reading is the same everywhere, and the other two are agreed upon. So one
// rank prints, and all end MPI in the ordinary way.
int
main(int argc, char **argv)
{
  if (const int code = without_mpi({argv + 1, argv + argc}); code >= 0)
    return code;
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  try
    {
      return execute({argv + 1, argv + argc}, MPI_COMM_WORLD);
    }
  catch (const SceneError &error)
    {
      return report(error.what(), bad_input);
    }
  catch (const OutputError &error)
    {
      return report(error.what(), bad_input);
    }
  catch (const NumericalFailure &error)
    {
      return report(error.what(), numerical_failure);
    }
  catch (const std::exception &error)
    {
      return report_unexpected(error.what());
    }
  catch (...)
    {
      return report_unexpected("unknown exception");
    }
}
