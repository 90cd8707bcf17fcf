#pragma once

#include <optional>
#include <string>
#include <vector>

namespace selkie
{
  /// Values given to parameters of a scene: "Section/Name=value" each.
  using Settings = std::vector<std::string>;

  /// One run of a study.
  struct StudyMember
  {
    std::string series;   ///< the curve to which it belongs
    std::string name;     ///< of its folder, "fem-02"
    Settings    settings; ///< beyond those of the scene
  };

  /// How a curve over time becomes a number.
  enum class Reduction
  {
    last,
    largest,
    smallest,
    mean,
    rms
  };

  /// What is measured: a column of one of the scene's probes, or of the
  /// statistics, and what it should be.
  struct StudyQuantity
  {
    std::string probe; ///< probes/NAME.csv; empty: statistics.csv
    std::string column;
    Reduction   reduction = Reduction::last;
    double      scale     = 1.; ///< of errors without a reference

    // The reference; at most one. None: the quantity is itself an error.
    std::optional<double> value;
    std::string           function; ///< of t, by muParser
    std::string           file;     ///< CSV: time, value
    Settings              run;      ///< of a finer run of this program
  };

  /**
   * The subsection `Study` of a .prm: which members a scene is run with, and
   * what is measured. Members are those of each named series: the product of
   * the lists in its `Vary`, after its `Settings`.
   */
  struct Study
  {
    std::string              file;  ///< the .prm of the study
    std::string              scene; ///< the .prm of the scene
    std::string              title;
    std::string              directory; ///< where everything is written
    StudyQuantity            quantity;
    std::vector<StudyMember> members; ///< series after series
    unsigned int             ranks       = 1;
    unsigned int             repetitions = 1;
    unsigned int directions = 0;  ///< in which members are refined; 0: all
    double       time_limit = 0.; ///< s a run; 0: none
  };

  /// @param overrides "--set", for the study's parameters or the scene's, and
  /// --output
  /// @throw SceneError naming file, parameter and what is allowed.
  Study
  read_study(const std::string              &file,
             const std::vector<std::string> &overrides);

  /**
   * The product of the lists in a text like
   *   Domain/Cells=8, 8 & Time/Step=0.1 | Domain/Cells=16, 16 & Time/Step=0.05;
   *   LME/Gamma=0.8 | 1.8 | 3
   * Lists are separated by semicolons, their items by bars; an item sets
   * several parameters with &. An item without a name has that of the first of
   * its list. The first list varies slowest.
   * @throw SceneError for an item that is no assignment.
   */
  std::vector<Settings>
  vary(const std::string &text);
} // namespace selkie
