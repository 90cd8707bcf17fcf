#include <selkie/base/exceptions.h>
#include <selkie/drivers/command_line.h>
#include <selkie/version.h>

#include <deal.II/base/config.h>

#include <algorithm>

namespace selkie
{
  namespace
  {
    using Command = CommandLine::Command;

    const std::string usage = "see 'selkie --help'";


    /// The commands that are words; `run` may be left out.
    bool
    read_command(const std::string &word, CommandLine &result)
    {
      if (word == "run")
        result.command = Command::run;
      else if (word == "check")
        result.command = Command::check;
      else if (word == "compare")
        result.command = Command::compare;
      else if (word == "parameters")
        result.command = Command::parameters;
      else if (word == "study")
        result.command = Command::study;
      else if (word == "report")
        result.command = Command::report;
      else if (word == "resume")
        result.command = Command::resume;
      else
        return false;
      return true;
    }


    /// The value behind an option: `--set A=b` or `--set=A=b`. Moves i to the
    /// last argument used.
    std::string
    option_value(const std::vector<std::string> &arguments,
                 const std::string              &option,
                 unsigned int                   &i)
    {
      if (arguments[i] != option)
        return arguments[i].substr(option.size() + 1);
      if (i + 1 >= arguments.size())
        throw SceneError("the option " + option + " needs a value; " + usage);
      return arguments[++i];
    }


    bool
    is_option(const std::string &argument, const std::string &option)
    {
      return argument == option || argument.rfind(option + "=", 0) == 0;
    }


    /// Of the commands that take the folders of runs.
    void
    read_folder_argument(const std::vector<std::string> &arguments,
                         unsigned int                   &i,
                         CommandLine                    &result)
    {
      const std::string &argument = arguments[i];
      if (is_option(argument, "--output"))
        result.output = option_value(arguments, "--output", i);
      else if (is_option(argument, "--reference") &&
               result.command == Command::report)
        result.references.push_back(option_value(arguments, "--reference", i));
      else if (argument.rfind("-", 0) == 0)
        throw SceneError("unknown option '" + argument + "' for '" +
                         arguments[0] +
                         "'; allowed is --output, and --reference for "
                         "'report'; " +
                         usage);
      else
        result.folders.push_back(argument);
    }


    void
    read_argument(const std::vector<std::string> &arguments,
                  unsigned int                   &i,
                  CommandLine                    &result)
    {
      const std::string &argument = arguments[i];
      if (is_option(argument, "--set"))
        result.overrides.push_back(option_value(arguments, "--set", i));
      else if (is_option(argument, "--output"))
        result.overrides.push_back("Output/Directory=" +
                                   option_value(arguments, "--output", i));
      else if (argument == "--markdown" &&
               result.command == Command::parameters)
        result.markdown = true;
      else if (argument.rfind("-", 0) == 0)
        throw SceneError("unknown option '" + argument +
                         "'; allowed are --set, --output, --help, --version, "
                         "and --markdown for 'parameters'; " +
                         usage);
      else if (result.command == Command::parameters)
        throw SceneError("'parameters' takes no file, but '" + argument +
                         "' was given; " + usage);
      else if (!result.file.empty())
        throw SceneError("two scenes, '" + result.file + "' and '" + argument +
                         "'; allowed is one; " + usage);
      else
        result.file = argument;
    }
  } // namespace


  CommandLine
  parse_command_line(const std::vector<std::string> &arguments)
  {
    CommandLine result;
    const auto  has = [&](const std::string &option) {
      return std::find(arguments.begin(), arguments.end(), option) !=
             arguments.end();
    };
    if (arguments.empty() || has("--help") || has("-h"))
      {
        result.command = Command::help;
        return result;
      }
    if (has("--version"))
      {
        result.command = Command::version;
        return result;
      }
    unsigned int i = read_command(arguments[0], result) ? 1 : 0;
    if (result.command == Command::compare || result.command == Command::report)
      {
        for (; i < arguments.size(); ++i)
          read_folder_argument(arguments, i, result);
        if (result.command == Command::report && result.folders.empty())
          throw SceneError("'report' needs the output folder of a run or a "
                           "study; " +
                           usage);
        if (result.command == Command::compare && result.folders.size() != 2)
          throw SceneError("'compare' needs the output folders of two runs, "
                           "but " +
                           std::to_string(result.folders.size()) +
                           " were given; " + usage);
        return result;
      }
    for (; i < arguments.size(); ++i)
      read_argument(arguments, i, result);
    if (result.command == Command::resume && result.file.empty())
      throw SceneError("'resume' needs the output folder of a run; " + usage);
    if (result.command != Command::parameters && result.file.empty())
      throw SceneError("no scene: the name of a .prm file is needed; " + usage);
    return result;
  }


  std::string
  help_text()
  {
    return R"(selkie: fluids and solids that move a lot and push on each other

  selkie [run] FILE.prm   run a scene
  selkie check FILE.prm   check a scene and say what a run would cost; run nothing
  selkie resume DIR       go on with a run from its last checkpoint
  selkie study FILE.prm   run a scene with many settings; draw error against time
  selkie report DIR...    make one HTML page of runs or of a study
  selkie compare A B      say what two finished runs differ in: their output folders
  selkie parameters       print all parameters with their defaults
  selkie --help           print this text
  selkie --version        print the version

  --set 'Section/Name=value'   a value stronger than the file's; may be repeated
  --output DIR                 where to write; default: output/ and the file's name;
                               'compare': A/compare_ and the name of B;
                               'report': DIR/report.html
  --reference PROBE=CSV        with 'report': a curve to draw over a probe's
  --markdown                   with 'parameters': as Markdown (doc/parameters.md)

For several processes: mpirun -np N selkie ...
Exit code: 0 done, 1 bad input or usage, 2 numerical failure after all retries.
)";
  }


  std::string
  version_text()
  {
    return std::string("selkie ") + SELKIE_VERSION + " (" + SELKIE_GIT_HASH +
           ", " + SELKIE_BUILD_TYPE + "), deal.II " + DEAL_II_PACKAGE_VERSION +
           "\n";
  }
} // namespace selkie
