#include <selkie/base/exceptions.h>
#include <selkie/base/text.h>
#include <selkie/scene/parameter_binding.h>
#include <selkie/scene/parameter_file.h>
#include <selkie/study/study.h>

#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    std::vector<std::string>
    split(const std::string &text, const char separator)
    {
      std::vector<std::string> parts;
      for (const auto &part : Utilities::split_string_list(text, separator))
        if (!Utilities::trim(part).empty())
          parts.push_back(Utilities::trim(part));
      return parts;
    }

    /// "A=1 & B=2"; a part without a name takes @p name.
    Settings
    read_settings(const std::string &text, const std::string &name = "")
    {
      Settings settings;
      for (std::string part : split(text, '&'))
        {
          // An assignment has a name without blanks at its ends, then '='.
          if (part.find('=') == std::string::npos && !name.empty())
            part = name + "=" + part;
          if (part.find('=') == std::string::npos)
            throw SceneError("'" + part +
                             "' gives no parameter a value; allowed are "
                             "items like Domain/Cells=8, 8");
          settings.push_back(part);
        }
      return settings;
    }

    /// A series before its members are known.
    struct Series
    {
      std::string name, settings, vary;
    };

    /// Everything of the subsection, as it is read.
    struct Parameters
    {
      Study               study;
      std::string         settings, value, run;
      std::vector<Series> series;
    };

    void
    declare_study(ParameterHandler &prm, Parameters &parameters)
    {
      Study         &study    = parameters.study;
      StudyQuantity &quantity = study.quantity;
      prm.enter_subsection("Study");
      prm.add_parameter("Title", study.title, "For plots. Units: none.");
      prm.add_parameter("Scene",
                        study.scene,
                        "The .prm that is run, relative to this one; the "
                        "default is this one. Units: none.");
      prm.add_parameter("Directory",
                        study.directory,
                        "Where everything is written; --output is the same. "
                        "The default is output/ and the name of the .prm. "
                        "Units: none.");
      prm.add_parameter("Settings",
                        parameters.settings,
                        "What all members set, 'Section/Name=value', joined by "
                        "&. Units: none.");
      prm.declare_entry("Series",
                        "",
                        Patterns::Anything(),
                        "Names of the curves, separated by commas; each is a "
                        "subsection. Units: none.");
      prm.add_parameter("Ranks",
                        study.ranks,
                        "Processes of each run. Units: none.",
                        Patterns::Integer(1));
      prm.add_parameter("Repetitions",
                        study.repetitions,
                        "How often each member is timed; times are medians. "
                        "If more than once, a timing of a short member is the "
                        "fastest of up to five runs. Units: none.",
                        Patterns::Integer(1));
      prm.add_parameter("Refined directions",
                        study.directions,
                        "In how many directions of space finer members have "
                        "more cells, for the orders of convergence; 0 for all. "
                        "Units: none.",
                        Patterns::Integer(0, 3));
      prm.add_parameter("Time limit",
                        study.time_limit,
                        "Of one run, then it is stopped and counts as failed; "
                        "0 for none. Units: s.",
                        Patterns::Double(0.));
      prm.enter_subsection("Quantity");
      prm.add_parameter("Probe",
                        quantity.probe,
                        "One of the scene's probes; empty: the statistics. "
                        "Units: none.");
      prm.add_parameter("Column",
                        quantity.column,
                        "Of the probe's or the statistics' file, without its "
                        "unit. Units: none.");
      add_choice(prm,
                 "Reduction",
                 quantity.reduction,
                 {{"last", Reduction::last},
                  {"largest", Reduction::largest},
                  {"smallest", Reduction::smallest},
                  {"mean", Reduction::mean},
                  {"rms", Reduction::rms}},
                 "How the curve over time becomes a number. With a reference "
                 "that is a curve: `rms` or `largest` of the difference. "
                 "Units: none.");
      prm.add_parameter("Scale",
                        quantity.scale,
                        "Without a reference: what the number is divided by, "
                        "so that it is a relative error. Units: the column's.",
                        Patterns::Double(std::numeric_limits<double>::min()));
      prm.add_parameter("Reference value",
                        parameters.value,
                        "What the number should be. Without any reference the "
                        "quantity is itself an error. Units: the column's.");
      prm.add_parameter("Reference function",
                        quantity.function,
                        "What the curve should be, of t. Units: the column's.");
      prm.add_parameter("Reference file",
                        quantity.file,
                        "The same as a CSV file, time and value, relative to "
                        "this .prm. Units: s and the column's.");
      prm.add_parameter("Reference run",
                        parameters.run,
                        "The settings of a finer run of this program, joined "
                        "by &. Units: none.");
      prm.leave_subsection();
      for (Series &series : parameters.series)
        {
          prm.enter_subsection(series.name);
          prm.add_parameter("Settings",
                            series.settings,
                            "What its members set. Units: none.");
          prm.add_parameter("Vary",
                            series.vary,
                            "What they vary: lists separated by semicolons, "
                            "their items by |. Units: none.");
          prm.leave_subsection();
        }
      prm.leave_subsection();
    }

    [[noreturn]] void
    refuse(const ParameterEntries &entries,
           const std::string      &file,
           const std::string      &path,
           const std::string      &why)
    {
      const ParameterEntry *entry = find_entry(entries, path);
      throw SceneError(
        entry != nullptr
          ? parameter_message(entry->origin, path, entry->value, why)
          : file + ": " + path + ": " + why);
    }

    void
    set_reference(const ParameterEntries &entries, Parameters &parameters)
    {
      StudyQuantity &quantity = parameters.study.quantity;
      if (!parameters.value.empty())
        try
          {
            quantity.value = Utilities::string_to_double(parameters.value);
          }
        catch (const ExceptionBase &)
          {
            refuse(entries,
                   parameters.study.file,
                   "Study/Quantity/Reference value",
                   "allowed is a number");
          }
      quantity.run = read_settings(parameters.run);
      if (int(quantity.value.has_value()) + !quantity.function.empty() +
            !quantity.file.empty() + !quantity.run.empty() >
          1)
        refuse(entries,
               parameters.study.file,
               "Study/Quantity",
               "allowed is one reference: a value, a function, a file or a "
               "run");
      if (quantity.column.empty())
        refuse(entries,
               parameters.study.file,
               "Study/Quantity/Column",
               "the quantity needs a column");
    }

    void
    set_members(const ParameterEntries &entries, Parameters &parameters)
    {
      Study         &study  = parameters.study;
      const Settings common = read_settings(parameters.settings);
      for (const Series &series : parameters.series)
        {
          const std::string path  = "Study/" + series.name;
          unsigned int      count = 0;
          try
            {
              const Settings of_series = read_settings(series.settings);
              for (const Settings &varied : vary(series.vary))
                {
                  StudyMember member;
                  member.series = series.name;
                  member.name = format("%s-%02u", series.name.c_str(), ++count);
                  std::replace(member.name.begin(),
                               member.name.end(),
                               ' ',
                               '_');
                  for (const auto *settings : {&common, &of_series, &varied})
                    member.settings.insert(member.settings.end(),
                                           settings->begin(),
                                           settings->end());
                  study.members.push_back(member);
                }
            }
          catch (const SceneError &error)
            {
              refuse(entries, study.file, path + "/Vary", error.what());
            }
        }
      if (study.members.empty())
        refuse(entries,
               study.file,
               "Study/Series",
               "the study needs a series, and it something to vary");
    }

    std::string
    beside(const std::string &file, const std::string &name)
    {
      namespace fs = std::filesystem;
      if (fs::path(name).is_absolute())
        return name;
      return (fs::path(file).parent_path() / name).lexically_normal().string();
    }
  } // namespace


  std::vector<Settings>
  vary(const std::string &text)
  {
    std::vector<Settings> product = {{}};
    for (const auto &list : split(text, ';'))
      {
        std::vector<Settings> items;
        std::string           name;
        for (const auto &item : split(list, '|'))
          {
            items.push_back(read_settings(item, name));
            if (name.empty())
              name = items[0][0].substr(0, items[0][0].find('='));
          }
        std::vector<Settings> longer;
        for (const Settings &so_far : product)
          for (const Settings &item : items)
            {
              longer.push_back(so_far);
              longer.back().insert(longer.back().end(),
                                   item.begin(),
                                   item.end());
            }
        product = longer;
      }
    return product;
  }


  Study
  read_study(const std::string &file, const std::vector<std::string> &overrides)
  {
    Parameters parameters;
    Study     &study     = parameters.study;
    study.file           = file;
    const auto stem      = std::filesystem::path(file).stem().string();
    study.directory      = "output/" + stem;
    study.title          = stem;
    const auto       all = read_entries(file, overrides);
    Settings         scenes; // overrides of the scene go to all members
    ParameterEntries mine;
    for (const ParameterEntry &entry : all)
      {
        const bool option =
          entry.origin.size() > 5 &&
          entry.origin.compare(entry.origin.size() - 5, 5, "--set") == 0;
        if (option && entry.path() == "Output/Directory")
          study.directory = entry.value;
        else if (!entry.sections.empty() && entry.sections[0] == "Study")
          mine.push_back(entry);
        else if (option)
          scenes.push_back(entry.path() + "=" + entry.value);
      }
    if (mine.empty())
      throw SceneError(file + ": there is no subsection 'Study'");
    for (const auto &name : split_list(value_of(mine, "Study/Series")))
      parameters.series.push_back({name, "", ""});

    ParameterHandler prm;
    declare_study(prm, parameters);
    apply_entries(prm, mine);
    study.scene = study.scene.empty() ? file : beside(file, study.scene);
    if (!study.quantity.file.empty())
      study.quantity.file = beside(file, study.quantity.file);
    set_reference(mine, parameters);
    set_members(mine, parameters);
    for (StudyMember &member : study.members)
      member.settings.insert(member.settings.end(),
                             scenes.begin(),
                             scenes.end());
    if (!study.quantity.run.empty())
      {
        const Settings common = read_settings(parameters.settings);
        study.quantity.run.insert(study.quantity.run.begin(),
                                  common.begin(),
                                  common.end());
      }
    return study;
  }
} // namespace selkie
