#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace selkie
{
  /**
   * Who spends the time of a loop whose parts are too short to be timed each:
   * every n-th pass is timed part by part, and the sums are scaled up. The
   * clock is read for sampled passes only, so the ledger costs next to nothing
   * (doc/performance.md).
   */
  class CostLedger
  {
  public:
    /// @param parts names, in the order of their indices
    explicit CostLedger(const std::vector<std::string> &parts);

    /// Begins a pass; whether it is a sampled one.
    bool
    begin_pass();

    /// In a sampled pass: books the time since the last call, or since
    /// begin_pass(), on a part.
    void
    book(const unsigned int part);

    struct Entry
    {
      std::string part;
      double      seconds; ///< estimate for all passes
    };
    std::vector<Entry>
    entries() const;

    /// One pass in so many is timed. A prime: passes come in rows of cells.
    static constexpr unsigned int sample_interval = 31;

  private:
    using Clock = std::chrono::steady_clock;

    std::vector<std::string> names;
    std::vector<double>      seconds; ///< of the sampled passes
    unsigned long long       passes = 0;
    Clock::time_point        last;
  };
} // namespace selkie
