#include <selkie/output/json.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace selkie
{
  namespace
  {
    /// The text in quotes, with what JSON wants escaped.
    std::string
    quoted(const std::string &text)
    {
      std::string result = "\"";
      for (const char c : text)
        if (c == '"' || c == '\\')
          result += std::string("\\") + c;
        else if (c == '\n')
          result += "\\n";
        else if (static_cast<unsigned char>(c) < 0x20)
          result += ' ';
        else
          result += c;
      return result + '"';
    }

    /// The text with its lines, but for the first, indented by two spaces.
    std::string
    indented(const std::string &text)
    {
      std::string result;
      for (const char c : text)
        result += c == '\n' ? std::string("\n  ") : std::string(1, c);
      return result;
    }

    std::string
    list(const std::vector<std::string> &items, const std::string &separator)
    {
      std::string result;
      for (const std::string &item : items)
        result += (result.empty() ? "" : separator) + item;
      return result;
    }
  } // namespace


  void
  JsonObject::add(const std::string &name, const std::string &text)
  {
    members.emplace_back(name, quoted(text));
  }


  void
  JsonObject::add(const std::string &name, const char *text)
  {
    add(name, std::string(text));
  }


  void
  JsonObject::add(const std::string              &name,
                  const std::vector<std::string> &texts)
  {
    std::vector<std::string> items;
    for (const std::string &text : texts)
      items.push_back(quoted(text));
    members.emplace_back(name, '[' + list(items, ", ") + ']');
  }


  void
  JsonObject::add(const std::string             &name,
                  const std::vector<JsonObject> &objects)
  {
    std::vector<std::string> items;
    for (const JsonObject &object : objects)
      items.push_back(object.text());
    members.emplace_back(name, '[' + list(items, ", ") + ']');
  }


  void
  JsonObject::add(const std::string &name, const JsonObject &object)
  {
    members.emplace_back(name, object.text());
  }


  void
  JsonObject::add_double(const std::string &name, const double value)
  {
    char number[32];
    std::snprintf(number, sizeof(number), "%.17g", value);
    members.emplace_back(name, std::isfinite(value) ? number : "null");
  }


  std::string
  JsonObject::text() const
  {
    std::vector<std::string> lines;
    for (const auto &[name, json] : members)
      lines.push_back("\n  " + quoted(name) + ": " + indented(json));
    return '{' + list(lines, ",") + "\n}";
  }


  void
  JsonObject::write(const std::string &path) const
  {
    std::ofstream file(path);
    file << text() << '\n';
    if (!file.flush())
      throw std::runtime_error("cannot write '" + path + "'");
  }
} // namespace selkie
