// Boost 1.74's property tree notes its own use of bind otherwise.
#define BOOST_BIND_GLOBAL_PLACEHOLDERS
#include <selkie/base/exceptions.h>
#include <selkie/output/run_folder.h>

#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/utilities.h>

#include <boost/property_tree/json_parser.hpp>

#include <filesystem>

namespace selkie
{
  namespace
  {
    /// Reads of parameters.prm what a scene of any version has.
    void
    read_parameters(const std::string &file, RunFolder &run)
    {
      dealii::ParameterHandler prm;
      prm.declare_entry("Dimension", "2", dealii::Patterns::Integer(2, 3));
      prm.declare_entry("Approximation", "lme mpm");
      prm.enter_subsection("Bodies");
      prm.declare_entry("Names", "");
      prm.leave_subsection();
      prm.parse_input(file, "", true);

      run.dimension     = prm.get_integer("Dimension");
      run.approximation = prm.get("Approximation");
      prm.enter_subsection("Bodies");
      run.bodies = dealii::Utilities::split_string_list(prm.get("Names"));
      prm.leave_subsection();
    }

    std::string
    why_unfinished(const std::string &summary)
    {
      if (!std::filesystem::exists(summary))
        return "there is no summary.json";
      try
        {
          boost::property_tree::ptree json;
          boost::property_tree::read_json(summary, json);
          return json.get<std::string>("failure");
        }
      catch (const boost::property_tree::ptree_error &)
        {
          return "its summary.json cannot be read";
        }
    }
  } // namespace


  RunFolder
  read_run_folder(const std::string &path)
  {
    namespace fs = std::filesystem;
    const fs::path folder(path);
    for (const char *file : {"parameters.prm", "statistics.csv"})
      if (!fs::is_regular_file(folder / file))
        throw SceneError("'" + path +
                         "' is not the output folder of a run of Selkie: it "
                         "has no " +
                         file);
    RunFolder run;
    run.path = path;
    run.name = fs::canonical(folder).filename().string();
    try
      {
        read_parameters((folder / "parameters.prm").string(), run);
      }
    catch (const dealii::ExceptionBase &)
      {
        throw SceneError("the file '" + path +
                         "/parameters.prm' is not one that Selkie wrote");
      }
    run.unfinished = why_unfinished((folder / "summary.json").string());
    return run;
  }
} // namespace selkie
