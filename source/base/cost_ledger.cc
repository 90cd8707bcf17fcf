#include <selkie/base/cost_ledger.h>

namespace selkie
{
  CostLedger::CostLedger(const std::vector<std::string> &parts)
    : names(parts)
    , seconds(parts.size(), 0.)
  {}


  bool
  CostLedger::begin_pass()
  {
    if (passes++ % sample_interval != 0)
      return false;
    last = Clock::now();
    return true;
  }


  void
  CostLedger::book(const unsigned int part)
  {
    const auto now = Clock::now();
    seconds[part] += std::chrono::duration<double>(now - last).count();
    last = now;
  }


  std::vector<CostLedger::Entry>
  CostLedger::entries() const
  {
    const unsigned long long sampled =
      (passes + sample_interval - 1) / sample_interval;
    std::vector<Entry> result;
    for (unsigned int i = 0; i < names.size(); ++i)
      result.push_back(
        {names[i],
         sampled == 0 ? 0. : seconds[i] * double(passes) / double(sampled)});
    return result;
  }
} // namespace selkie
