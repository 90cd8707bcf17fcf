#pragma once

#include <selkie/output/audit.h>
#include <selkie/output/verdict.h>
#include <selkie/time/time_control.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace selkie
{
  /// Where the energy went since the start (J).
  struct Energies
  {
    double initial    = 0;
    double potential  = 0; ///< at the start
    double dissipated = 0, external_work = 0;
    double of_reset = 0, of_volume = 0; ///< given by the fluid's rules

    double
    balance(const Audit &now) const
    {
      return now.energy() + dissipated - external_work - of_volume - initial;
    }

    /// What a gain or loss is measured by: all that moves or is stored, and
    /// what gravity or loads have given.
    double
    in_play(const Audit &now) const
    {
      const double sum = std::max(now.kinetic + now.strain + now.compression,
                                  initial - potential) +
                         std::abs(now.potential - potential) +
                         std::abs(external_work);
      return sum > 0. ? sum : 1.;
    }
  };

  /// What a run carries from step to step besides points and nodes: with these
  /// in a checkpoint it goes on as if nothing had been.
  struct RunState
  {
    TimeControl::State time;
    double             volume_excess = 0; ///< of the stepper

    Energies                  energies;
    std::vector<Verdict::Row> verdict;
    double                    initial_volume = 0; ///< m^dim

    /// Of the time steps, on request: sums over them (m).
    double error = 0, largest_error = 0, path = 0;

    unsigned long long  unknowns    = 0; ///< most in any step
    double              next_fields = 0; ///< s
    std::vector<double> next_records;    ///< of the recorders (s)

    /// The pictures so far: time (s) and file.
    using Pictures = std::vector<std::pair<double, std::string>>;
    Pictures particle_files, mesh_files;
    double   wall = 0; ///< s, of the parts before a checkpoint
  };
} // namespace selkie

namespace boost
{
  namespace serialization
  {
    template <class Archive>
    void
    serialize(Archive                    &ar,
              selkie::TimeControl::State &s,
              const unsigned int /*version*/)
    {
      ar &s.t &s.dt &s.allowed &s.by_error &s.n &s.n_cuts &s.good &s.rule;
      for (auto &count : s.ruled)
        ar &count;
    }

    template <class Archive>
    void
    serialize(Archive &ar, selkie::Energies &e, const unsigned int /*version*/)
    {
      ar &e.initial &e.potential &e.dissipated &e.external_work &e.of_reset &e
        .of_volume;
    }

    template <class Archive>
    void
    serialize(Archive              &ar,
              selkie::Verdict::Row &row,
              const unsigned int /*version*/)
    {
      ar &row.figure   &row.limit[0] & row.limit[1] &
        row.from_below &row.worst &row.first[0] & row.first[1];
    }

    template <class Archive>
    void
    serialize(Archive &ar, selkie::RunState &s, const unsigned int /*version*/)
    {
      ar &s.time &s.volume_excess &s.energies &s.verdict &s.initial_volume &s
        .error &s.largest_error &s.path &s.unknowns &s.next_fields &s
        .next_records &s.particle_files &s.mesh_files &s.wall;
    }
  } // namespace serialization
} // namespace boost
