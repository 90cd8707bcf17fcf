#include <selkie/base/timer_tree.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <ostream>

namespace selkie
{
  /// A node of the tree.
  struct TimerTree::Section
  {
    /// A moment, or a span, on the two clocks (s).
    struct Times
    {
      double wall = 0;
      double cpu  = 0;

      static Times
      now()
      {
        using namespace std::chrono;
        timespec cpu;
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
        return {
          duration<double>(steady_clock::now().time_since_epoch()).count(),
          cpu.tv_sec + 1e-9 * cpu.tv_nsec};
      }

      void
      add_span(const Times &from, const Times &to)
      {
        wall += to.wall - from.wall;
        cpu += to.cpu - from.cpu;
      }
    };

    std::string                           name;
    Section                              *parent = nullptr;
    unsigned long long                    calls  = 0;
    bool                                  open   = false;
    Times                                 start;
    Times                                 closed; ///< sum of the ended calls
    std::vector<std::unique_ptr<Section>> children;

    void
    begin()
    {
      ++calls;
      open  = true;
      start = Times::now();
    }

    void
    end()
    {
      closed.add_span(start, Times::now());
      open = false;
    }

    /// All calls up to @p now.
    Times
    total(const Times &now) const
    {
      Times sum = closed;
      if (open)
        sum.add_span(start, now);
      return sum;
    }

    Section *
    child(const std::string &child_name)
    {
      for (const auto &section : children)
        if (section->name == child_name)
          return section.get();
      children.push_back(std::make_unique<Section>());
      children.back()->name   = child_name;
      children.back()->parent = this;
      return children.back().get();
    }

    /// Appends the rows of this section and of all below it.
    void
    list(const std::string &path,
         const unsigned int depth,
         const Times       &now,
         std::vector<Row>  &rows) const
    {
      const Times sum = total(now);
      rows.push_back({path, depth, calls, sum.wall, sum.cpu, 0.});

      const std::string prefix = depth == 0 ? "" : path + "/";
      Times             rest   = sum;
      for (const auto &section : children)
        {
          section->list(prefix + section->name, depth + 1, now, rows);
          rest.add_span(section->total(now), {});
        }
      if (!children.empty())
        rows.push_back(
          {prefix + "other", depth + 1, calls, rest.wall, rest.cpu, 0.});
    }
  };


  namespace
  {
    /// Takes the largest values of two ranks; sections unknown to @p rows are
    /// put after the last one of the same parent.
    void
    merge(const std::vector<TimerTree::Row> &others,
          std::vector<TimerTree::Row>       &rows)
    {
      for (const TimerTree::Row &other : others)
        {
          auto row = std::find_if(rows.begin(), rows.end(), [&](const auto &r) {
            return r.path == other.path;
          });
          if (row != rows.end())
            {
              row->calls = std::max(row->calls, other.calls);
              row->wall  = std::max(row->wall, other.wall);
              row->cpu   = std::max(row->cpu, other.cpu);
              continue;
            }
          const std::string parent =
            other.path.substr(0, other.path.find_last_of('/') + 1);
          auto last = std::find_if(rows.rbegin(), rows.rend(), [&](auto &r) {
            return (r.path + "/").compare(0, parent.size(), parent) == 0;
          });
          rows.insert(last.base(), other);
        }
    }
  } // namespace


  TimerTree::TimerTree(const MPI_Comm comm)
    : comm(comm)
    , run(std::make_unique<Section>())
    , open(run.get())
  {
    run->name = "total";
    run->begin();
  }


  TimerTree::~TimerTree() = default;


  TimerTree::Scope::Scope(TimerTree &timers, const std::string &name)
    : timers(timers)
  {
    Assert(name.find('/') == std::string::npos,
           dealii::ExcMessage("a '/' in the section's name " + name));
    timers.open = timers.open->child(name);
    timers.open->begin();
  }


  TimerTree::Scope::~Scope()
  {
    timers.open->end();
    timers.open = timers.open->parent;
  }


  double
  TimerTree::wall_time() const
  {
    return run->total(Section::Times::now()).wall;
  }


  std::vector<TimerTree::Row>
  TimerTree::rows() const
  {
    std::vector<Row> mine;
    run->list(run->name, 0, Section::Times::now(), mine);

    const auto       of_ranks = dealii::Utilities::MPI::all_gather(comm, mine);
    std::vector<Row> rows     = of_ranks[0];
    for (unsigned int rank = 1; rank < of_ranks.size(); ++rank)
      merge(of_ranks[rank], rows);
    for (Row &row : rows)
      row.share = row.wall / rows[0].wall;
    return rows;
  }


  void
  TimerTree::print(Log &log) const
  {
    log.line("section                                  "
             "    calls    wall (s)     cpu (s)   share");
    for (const Row &row : rows())
      {
        const std::string indented =
          std::string(2 * row.depth, ' ') +
          row.path.substr(row.path.find_last_of('/') + 1);
        char text[128];
        std::snprintf(text,
                      sizeof(text),
                      "%-40.40s %9llu %11.3f %11.3f %6.1f%%",
                      indented.c_str(),
                      row.calls,
                      row.wall,
                      row.cpu,
                      100 * row.share);
        log.line(text);
      }
  }


  void
  TimerTree::write_csv(const std::vector<Row> &rows, std::ostream &out)
  {
    out << "path,calls,wall (s),cpu (s),share (%)\n";
    for (const Row &row : rows)
      out << row.path << ',' << row.calls << ',' << row.wall << ',' << row.cpu
          << ',' << 100 * row.share << '\n';
  }
} // namespace selkie
