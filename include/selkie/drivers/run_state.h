#pragma once

#include <selkie/drivers/kept_numbers.h>
#include <selkie/drivers/run_audit.h>
#include <selkie/time/time_control.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <string>
#include <utility>
#include <vector>

namespace selkie
{
  /// What a run carries from step to step besides points and nodes: with these
  /// in a checkpoint it goes on as if nothing had been.
  struct RunState
  {
    TimeControl::State time;
    KeptNumbers        stepper;

    AuditState audit; ///< with the effect `audit`

    /// Of the time steps, on request: sums over them (m).
    double error = 0, largest_error = 0, path = 0;

    unsigned long long  unknowns    = 0; ///< most in any step
    unsigned long long  nonzeros    = 0; ///< of the matrix, most in any step
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
      ar &s.t;
      ar &s.dt;
      ar &s.allowed;
      ar &s.by_error;
      ar &s.n;
      ar &s.n_cuts;
      ar &s.good;
      ar &s.rule;
      for (auto &count : s.ruled)
        ar &count;
    }

    template <class Archive>
    void
    serialize(Archive &ar, selkie::Energies &e, const unsigned int /*version*/)
    {
      ar &e.initial;
      ar &e.potential;
      ar &e.dissipated;
      ar &e.external_work;
      ar &e.of_reset;
      ar &e.of_volume;
      ar &e.of_adapting;
    }

    template <class Archive>
    void
    serialize(Archive              &ar,
              selkie::Verdict::Row &row,
              const unsigned int /*version*/)
    {
      ar &row.figure;
      ar &row.limit[0];
      ar &row.limit[1];
      ar &row.from_below;
      ar &row.worst;
      ar &row.first[0];
      ar &row.first[1];
    }

    template <class Archive>
    void
    serialize(Archive            &ar,
              selkie::AuditState &s,
              const unsigned int /*version*/)
    {
      ar &s.energies;
      ar &s.verdict;
      ar &s.initial_volume;
    }

    template <class Archive>
    void
    serialize(Archive &ar, selkie::RunState &s, const unsigned int /*version*/)
    {
      ar &s.time;
      ar &s.stepper.volume_excess;
      ar &s.stepper.moved;
      ar &s.audit;
      ar &s.error;
      ar &s.largest_error;
      ar &s.path;
      ar &s.unknowns;
      ar &s.nonzeros;
      ar &s.next_fields;
      ar &s.next_records;
      ar &s.particle_files;
      ar &s.mesh_files;
      ar &s.wall;
    }
  } // namespace serialization
} // namespace boost
