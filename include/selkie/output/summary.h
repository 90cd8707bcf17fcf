#pragma once

#include <selkie/base/cost_ledger.h>
#include <selkie/base/timer_tree.h>
#include <selkie/output/audit.h>
#include <selkie/output/verdict.h>
#include <selkie/particles/particle_set.h>

#include <optional>
#include <string>
#include <vector>

namespace selkie
{
  /// What summary.json says about a run; versions and build type are added.
  struct Summary
  {
    std::string              title, file;
    std::vector<std::string> effects;
    unsigned int             ranks = 1;

    unsigned long long points          = 0;
    unsigned long long unknowns        = 0; ///< most in any step
    unsigned int       bytes_per_point = 0; ///< of particle columns
    unsigned long long nonzeros        = 0; ///< of the matrix, most in any step
    unsigned int       steps           = 0;
    double             end_time        = 0; ///< reached (s)

    std::string failure; ///< empty: done; else why the run ended

    /// Estimates, on request; relative ones to what moved.
    struct Errors
    {
      double time = 0, time_relative = 0, largest_step = 0; ///< m, 1, m
      double space = 0, space_relative = 0;                 ///< m/s or m, 1
    };
    std::optional<Errors>  errors;
    std::optional<Audit>   audit; ///< at the end
    std::optional<Verdict> verdict;
    ParticleAccounting     accounting;

    double                         wall_time = 0; ///< s
    std::vector<TimerTree::Row>    timings;
    std::vector<CostLedger::Entry> costs; ///< of the assembly, by term
  };

  /// Writes summary.json; call it on one rank.
  /// @throw std::runtime_error if it cannot be written.
  void
  write_summary(const std::string &path, const Summary &summary);
} // namespace selkie
