#include <selkie/output/banner.h>
#include <selkie/output/json.h>
#include <selkie/output/summary.h>

#include <cmath>

namespace selkie
{
  namespace
  {
    JsonObject
    to_json(const Versions &versions)
    {
      JsonObject json;
      json.add("selkie", versions.selkie);
      json.add("git", versions.git_hash);
      json.add("deal.II", versions.deal_ii);
      json.add("Trilinos", versions.trilinos);
      json.add("p4est", versions.p4est);
      return json;
    }

    JsonObject
    to_json(const dealii::Tensor<1, 3> &vector)
    {
      JsonObject json;
      json.add("x", vector[0]);
      json.add("y", vector[1]);
      json.add("z", vector[2]);
      return json;
    }

    JsonObject
    to_json(const Audit &audit)
    {
      JsonObject json;
      json.add("kinetic energy", audit.kinetic);
      json.add("strain energy", audit.strain);
      json.add("compression energy", audit.compression);
      json.add("potential energy", audit.potential);
      json.add("mass", audit.mass);
      json.add("volume", audit.volume);
      json.add("min J", audit.min_J);
      json.add("max J", audit.max_J);
      json.add("momentum", to_json(audit.momentum));
      json.add("angular momentum", to_json(audit.angular_momentum));
      json.add("center of mass", to_json(audit.center));
      return json;
    }

    JsonObject
    to_json(const ParticleAccounting &accounting)
    {
      JsonObject json;
      json.add("seeded", accounting.seeded);
      json.add("removed", accounting.removed);
      json.add("kept at wall", accounting.kept_at_wall);
      if (accounting.split + accounting.merged > 0)
        {
          json.add("split", accounting.split);
          json.add("merged", accounting.merged);
        }
      json.add("seeded mass", accounting.seeded_mass);
      json.add("removed mass", accounting.removed_mass);
      return json;
    }

    std::vector<JsonObject>
    to_json(const std::vector<TimerTree::Row> &timings)
    {
      std::vector<JsonObject> list;
      for (const TimerTree::Row &row : timings)
        {
          list.emplace_back();
          list.back().add("section", row.path);
          list.back().add("calls", row.calls);
          list.back().add("wall (s)", row.wall);
          list.back().add("share", row.share);
        }
      return list;
    }

    std::vector<JsonObject>
    to_json(const std::vector<CostLedger::Entry> &costs)
    {
      double total = 0.;
      for (const CostLedger::Entry &entry : costs)
        total += entry.seconds;
      std::vector<JsonObject> list;
      for (const CostLedger::Entry &entry : costs)
        {
          list.emplace_back();
          list.back().add("part", entry.part);
          list.back().add("seconds", entry.seconds);
          list.back().add("share", total > 0. ? entry.seconds / total : 0.);
        }
      return list;
    }

    JsonObject
    to_json(const Verdict &verdict)
    {
      std::vector<JsonObject> figures;
      for (const Verdict::Row &row : verdict.rows())
        {
          figures.emplace_back();
          JsonObject &json = figures.back();
          json.add("figure", row.figure);
          json.add("grade", to_string(row.grade()));
          json.add("worst", row.worst);
          json.add("warning", row.limit[0]);
          json.add("failure", row.limit[1]);
          json.add("bad", row.from_below ? "below" : "above");
          for (unsigned int k = 0; k < 2; ++k)
            if (!std::isnan(row.first[k]))
              json.add(k == 0 ? "warned at (s)" : "failed at (s)",
                       row.first[k]);
        }
      JsonObject json;
      json.add("grade", to_string(verdict.grade()));
      json.add("figures", figures);
      return json;
    }

    JsonObject
    to_json(const Summary::Errors &errors)
    {
      JsonObject json;
      json.add("time steps, sum (m)", errors.time);
      json.add("time steps, of the path", errors.time_relative);
      json.add("largest of a step (m)", errors.largest_step);
      json.add("mesh, last step", errors.space);
      json.add("mesh, of the velocity", errors.space_relative);
      return json;
    }
  } // namespace


  void
  write_summary(const std::string &path, const Summary &summary)
  {
    const Versions v = versions();
    JsonObject     json;
    json.add("title", summary.title);
    json.add("file", summary.file);
    json.add("verdict", summary.failure.empty() ? "done" : "failure");
    json.add("failure", summary.failure);
    json.add("versions", to_json(v));
    json.add("build type", v.build_type);
    json.add("ranks", summary.ranks);
    json.add("effects", summary.effects);
    json.add("points", summary.points);
    json.add("bytes per point", summary.bytes_per_point);
    json.add("unknowns", summary.unknowns);
    json.add("matrix nonzeros", summary.nonzeros);
    json.add("steps", summary.steps);
    json.add("final time (s)", summary.end_time);
    if (summary.audit)
      json.add("final figures", to_json(*summary.audit));
    if (summary.verdict)
      json.add("audit", to_json(*summary.verdict));
    json.add("material points", to_json(summary.accounting));
    if (summary.errors)
      json.add("estimated errors", to_json(*summary.errors));
    json.add("wall time (s)", summary.wall_time);
    json.add("assembly by effect", to_json(summary.costs));
    json.add("timings", to_json(summary.timings));
    json.write(path);
  }
} // namespace selkie
