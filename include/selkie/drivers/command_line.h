#pragma once

#include <string>
#include <vector>

namespace selkie
{
  /// What the user asks for.
  struct CommandLine
  {
    enum class Command
    {
      run,        ///< read, check and run a scene
      check,      ///< read and check it, say what a run would cost
      compare,    ///< say what two finished runs differ in
      parameters, ///< print the reference of all parameters
      resume,     ///< go on with a run from its last checkpoint
      report,     ///< make a page of a run or a study
      study,      ///< run a scene with many settings: error against time
      help,
      version
    };
    Command                  command = Command::run;
    std::string              file;
    std::vector<std::string> overrides; ///< --set and --output
    bool                     markdown = false;
    std::vector<std::string> folders;    ///< of runs: compare, report
    std::vector<std::string> references; ///< of probes: report
    std::string              output;     ///< where what is made of them goes
  };

  /// @param arguments without the program's name
  /// @throw SceneError for an unknown option, a missing file and the like.
  CommandLine
  parse_command_line(const std::vector<std::string> &arguments);

  /// The text of --help.
  std::string
  help_text();

  /// The text of --version: version, git hash, build type, libraries.
  std::string
  version_text();
} // namespace selkie
