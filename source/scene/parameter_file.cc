#include <selkie/base/exceptions.h>
#include <selkie/scene/parameter_file.h>

#include <deal.II/base/utilities.h>

#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/ptree.hpp>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    using Utilities::trim;

    std::string
    join(const std::vector<std::string> &parts, const std::string &separator)
    {
      std::string text;
      for (const auto &part : parts)
        text += (text.empty() ? "" : separator) + part;
      return text;
    }


    /// Reads a .prm line by line.
    class PrmReader
    {
    public:
      explicit PrmReader(const std::string &file)
        : file(file)
      {}

      ParameterEntries
      read()
      {
        std::ifstream in(file);
        std::string   text;
        if (!in || !std::getline(in, text, '\0'))
          throw SceneError(file + ": the scene cannot be read: there is no "
                                  "such file, or it is empty or unreadable");
        std::istringstream lines(text);
        for (std::string line; next_line(lines, line);)
          take(line);
        if (!sections.empty())
          throw SceneError(origin() + ": the subsection '" + sections.back() +
                           "' has no 'end'");
        return entries;
      }

    private:
      std::string
      origin() const
      {
        return file + ":" + std::to_string(line_number);
      }

      /// The next line without its comment, lines that end in a backslash
      /// joined to the following one.
      bool
      next_line(std::istream &in, std::string &line)
      {
        line.clear();
        for (std::string part; std::getline(in, part);)
          {
            ++line_number;
            part = trim(part.substr(0, part.find('#')));
            if (part.empty() || part.back() != '\\')
              {
                line += part;
                return true;
              }
            part.back() = ' ';
            line += part;
          }
        return !line.empty();
      }

      void
      take(const std::string &line)
      {
        const std::size_t blank = line.find_first_of(" \t");
        const std::string word  = line.substr(0, blank);
        const std::string rest =
          blank == std::string::npos ? "" : trim(line.substr(blank));
        const std::size_t equal = rest.find('=');
        if (line.empty())
          return;
        if (word == "subsection" && !rest.empty())
          sections.push_back(rest);
        else if (word == "end" && rest.empty() && !sections.empty())
          sections.pop_back();
        else if (word == "set" && equal != std::string::npos)
          add(trim(rest.substr(0, equal)), trim(rest.substr(equal + 1)));
        else
          throw SceneError(origin() + ": the line '" + line +
                           "' cannot be read. Allowed are 'set NAME = VALUE', "
                           "'subsection NAME', its 'end', and comments after "
                           "'#'");
      }

      void
      add(const std::string &name, const std::string &value)
      {
        entries.push_back({sections, name, value, origin()});
        const auto found =
          given.insert({entries.back().path(), entries.back().origin});
        if (!found.second)
          throw SceneError(
            parameter_message(origin(),
                              entries.back().path(),
                              value,
                              "it was set before, at " + found.first->second +
                                "; a parameter can be set once"));
      }

      const std::string                  file;
      unsigned int                       line_number = 0;
      std::vector<std::string>           sections;
      ParameterEntries                   entries;
      std::map<std::string, std::string> given; ///< path, origin
    };


    ParameterEntry
    read_override(const std::string &file, const std::string &text)
    {
      const std::size_t equal = text.find('=');
      if (equal == std::string::npos || trim(text.substr(0, equal)).empty())
        throw SceneError(file + ", --set '" + text +
                         "': allowed is 'Section/Subsection/Name=value'");
      ParameterEntry entry;
      for (const auto &part :
           Utilities::split_string_list(text.substr(0, equal), '/'))
        entry.sections.push_back(trim(part));
      entry.name = entry.sections.back();
      entry.sections.pop_back();
      entry.value  = trim(text.substr(equal + 1));
      entry.origin = file + ", --set";
      return entry;
    }


    /// "1" of "[Integer range 1...9 (inclusive)]", or "" for the largest
    /// number of the type.
    std::string
    bounds_in_words(const std::string &description)
    {
      const std::size_t dots  = description.find("...");
      const std::size_t first = description.rfind(' ', dots);
      const std::size_t last  = description.find(' ', dots);
      if (dots == std::string::npos)
        return "";
      const std::string lower = description.substr(first + 1, dots - first - 1);
      const std::string upper = description.substr(dots + 3, last - dots - 3);
      const bool        has_lower = (lower != "-MAX_DOUBLE");
      const bool has_upper = (upper != "MAX_DOUBLE" && upper != "2147483647");
      return has_lower && has_upper ? " from " + lower + " to " + upper
             : has_lower            ? ", at least " + lower
             : has_upper            ? ", at most " + upper
                                    : "";
    }


    /// deal.II's description of a pattern, in words.
    std::string
    in_words(const std::string &description)
    {
      const auto starts = [&](const std::string &word) {
        return description.rfind("[" + word, 0) == 0;
      };
      if (starts("Integer"))
        return "an integer" + bounds_in_words(description);
      if (starts("Double"))
        return "a number" + bounds_in_words(description);
      if (starts("Bool"))
        return "true or false";
      if (starts("Anything"))
        return "any text";
      if (starts("Selection") || starts("MultipleSelection"))
        {
          std::string choices = description.substr(description.find(' '));
          choices             = trim(choices.substr(0, choices.size() - 1));
          return (starts("Selection") ? "one of: " : "any of: ") +
                 join(Utilities::split_string_list(choices, '|'), ", ");
        }
      if (starts("List"))
        {
          const std::size_t inner = description.find('<') + 1;
          const std::size_t outer = description.rfind('>');
          const std::size_t count = description.find("length ", outer);
          const std::size_t dots  = description.find("...", outer);
          return description.substr(count + 7, dots - count - 7) +
                 " values separated by commas, each " +
                 in_words(description.substr(inner, outer - inner));
        }
      return description;
    }


    void
    collect(const boost::property_tree::ptree &tree,
            const std::string                 &prefix,
            std::vector<DeclaredParameter>    &result)
    {
      for (const auto &[name, child] : tree)
        if (child.find("pattern_description") == child.not_found())
          collect(child, prefix + name + "/", result);
        else
          result.push_back(
            {prefix + name,
             child.get<std::string>("value"),
             child.get<std::string>("default_value"),
             child.get<std::string>("documentation"),
             in_words(child.get<std::string>("pattern_description"))});
    }


    /// Where the name of an undeclared subsection would have to be listed.
    std::string
    hint_at_names(const ParameterHandler         &prm,
                  const std::vector<std::string> &sections)
    {
      std::string              parent;
      std::vector<std::string> path;
      for (const auto &section : sections)
        {
          path.push_back(section);
          if (prm.subsection_path_exists(path))
            {
              parent += section + "/";
              continue;
            }
          for (const auto &parameter : declared_parameters(prm))
            if (parameter.path == parent + "Names")
              return "; '" + parameter.path + "' does not list '" + section +
                     "'";
          break;
        }
      return "";
    }


    /// What an undeclared parameter could have been instead.
    std::string
    why_unknown(const ParameterHandler &prm, const ParameterEntry &entry)
    {
      const std::string        section = join(entry.sections, "/");
      const std::string        prefix  = section.empty() ? "" : section + "/";
      std::vector<std::string> names;
      std::set<std::string>    subsections;
      for (const auto &parameter : declared_parameters(prm))
        {
          if (parameter.path.rfind(prefix, 0) != 0)
            continue;
          const std::string rest  = parameter.path.substr(prefix.size());
          const std::size_t slash = rest.find('/');
          if (slash == std::string::npos)
            names.push_back(rest);
          else
            subsections.insert(rest.substr(0, slash));
        }
      if (names.empty() && subsections.empty())
        return "there is no subsection '" + section + "' in this scene" +
               hint_at_names(prm, entry.sections);
      std::string why =
        "there is no such parameter. Allowed here are: " + join(names, ", ");
      if (!subsections.empty())
        why += "; subsections: " +
               join({subsections.begin(), subsections.end()}, ", ");
      return why;
    }


    std::string
    allowed_values(const ParameterHandler &prm, const std::string &path)
    {
      for (const auto &parameter : declared_parameters(prm))
        if (parameter.path == path)
          return "allowed is " + parameter.allowed + ". " +
                 parameter.documentation;
      return "";
    }


    void
    apply_entry(ParameterHandler &prm, const ParameterEntry &entry)
    {
      const auto fail = [&](const std::string &why) {
        throw SceneError(
          parameter_message(entry.origin, entry.path(), entry.value, why));
      };
      if (!entry.sections.empty() &&
          !prm.subsection_path_exists(entry.sections))
        fail(why_unknown(prm, entry));
      for (const auto &section : entry.sections)
        prm.enter_subsection(section);
      std::string why;
      try
        {
          prm.set(entry.name, entry.value);
        }
      catch (const ParameterHandler::ExcEntryUndeclared &)
        {
          why = why_unknown(prm, entry);
        }
      catch (const ParameterHandler::ExcValueDoesNotMatchPattern &)
        {
          why = allowed_values(prm, entry.path());
        }
      catch (const SceneError &error)
        {
          why = error.what();
        }
      for (unsigned int i = 0; i < entry.sections.size(); ++i)
        prm.leave_subsection();
      if (!why.empty())
        fail(why);
    }
  } // namespace


  std::string
  ParameterEntry::path() const
  {
    return sections.empty() ? name : join(sections, "/") + "/" + name;
  }


  ParameterEntries
  read_entries(const std::string              &file,
               const std::vector<std::string> &overrides)
  {
    ParameterEntries entries = PrmReader(file).read();
    for (const auto &text : overrides)
      entries.push_back(read_override(file, text));
    return entries;
  }


  const ParameterEntry *
  find_entry(const ParameterEntries &entries, const std::string &path)
  {
    const auto found =
      std::find_if(entries.rbegin(), entries.rend(), [&](const auto &entry) {
        return entry.path() == path;
      });
    return found == entries.rend() ? nullptr : &*found;
  }


  std::string
  value_of(const ParameterEntries &entries,
           const std::string      &path,
           const std::string      &default_value)
  {
    const ParameterEntry *entry = find_entry(entries, path);
    return entry ? entry->value : default_value;
  }


  void
  apply_entries(ParameterHandler &prm, const ParameterEntries &entries)
  {
    for (const auto &entry : entries)
      apply_entry(prm, entry);
  }


  std::vector<DeclaredParameter>
  declared_parameters(const ParameterHandler &prm)
  {
    std::stringstream json;
    prm.print_parameters(json,
                         ParameterHandler::JSON |
                           ParameterHandler::KeepDeclarationOrder);
    boost::property_tree::ptree tree;
    boost::property_tree::read_json(json, tree);
    std::vector<DeclaredParameter> result;
    collect(tree, "", result);
    return result;
  }


  std::string
  parameter_message(const std::string &origin,
                    const std::string &path,
                    const std::string &value,
                    const std::string &why)
  {
    return (origin.empty() ? "" : origin + ": ") + "parameter '" + path +
           "' = '" + value + "': " + why;
  }


  std::vector<std::string>
  split_list(const std::string &text)
  {
    std::vector<std::string> items;
    for (const auto &item : Utilities::split_string_list(text, ','))
      if (!item.empty())
        items.push_back(item);
    return items;
  }
} // namespace selkie
