#pragma once

#include <selkie/base/log.h>

#include <deal.II/base/mpi.h>

#include <chrono>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace selkie
{
  /**
   * Wall and CPU time of nested sections, and of what no section covers.
   *
   * A section is open as long as its Scope lives, and belongs to the section
   * that is open when it starts:
   * @code
   *   TimerTree::Scope step(timers, "step");
   *   {
   *     TimerTree::Scope assemble(timers, "assemble"); // path step/assemble
   *     ...
   *   }
   * @endcode
   * Ranks may enter different sections.
   */
  class TimerTree
  {
  public:
    /// The clock of the whole run starts here.
    explicit TimerTree(const MPI_Comm comm);
    ~TimerTree();

    TimerTree(const TimerTree &) = delete;
    TimerTree &
    operator=(const TimerTree &) = delete;

  private:
    struct Section;

  public:
    /// Times a section from construction to destruction, exceptions included.
    class Scope
    {
    public:
      /// @param name without '/'
      Scope(TimerTree &timers, const std::string &name);
      ~Scope();

      Scope(const Scope &) = delete;
      Scope &
      operator=(const Scope &) = delete;

    private:
      TimerTree &timers;
    };

    /// One section, or the rest `other` of its parent: the time in the parent
    /// that none of its sections covers.
    struct Row
    {
      std::string        path;      ///< e.g. "step/assemble"; the run: "total"
      unsigned int       depth = 0; ///< 0 for the run
      unsigned long long calls = 0; ///< largest of any rank
      double             wall  = 0; ///< s, largest of any rank
      double             cpu   = 0; ///< s, largest of any rank
      double             share = 0; ///< wall as part of the run's

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        // clang-format off
        archive & path & depth & calls & wall & cpu & share;
        // clang-format on
      }
    };

    /// Seconds since construction on this rank.
    double
    wall_time() const;

    /// The run, its sections in the order of their first start, and the rest
    /// of each. Open sections count up to now. Collective.
    std::vector<Row>
    rows() const;

    /// The table of rows(). Collective.
    void
    print(Log &log) const;

    /// The table of rows() as CSV.
    static void
    write_csv(const std::vector<Row> &rows, std::ostream &out);

  private:
    const MPI_Comm           comm;
    std::unique_ptr<Section> run;
    Section                 *open; ///< the innermost open section
  };
} // namespace selkie
