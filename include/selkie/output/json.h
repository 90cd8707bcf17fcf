#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace selkie
{
  /// A JSON object that is written once: numbers stay numbers, members keep
  /// their order. Reading is boost::property_tree's job.
  class JsonObject
  {
  public:
    void
    add(const std::string &name, const std::string &text);

    void
    add(const std::string &name, const char *text);

    /// Doubles with 17 digits; null if not finite.
    template <typename Number,
              typename = std::enable_if_t<std::is_arithmetic<Number>::value>>
    void
    add(const std::string &name, const Number value)
    {
      if constexpr (std::is_integral<Number>::value)
        members.emplace_back(name, std::to_string(value));
      else
        add_double(name, value);
    }

    void
    add(const std::string &name, const std::vector<std::string> &texts);

    void
    add(const std::string &name, const std::vector<JsonObject> &objects);

    void
    add(const std::string &name, const JsonObject &object);

    /// The object over several lines, members indented by two spaces.
    std::string
    text() const;

    /// Writes text() to a file.
    /// @throw std::runtime_error if it cannot be written.
    void
    write(const std::string &path) const;

  private:
    void
    add_double(const std::string &name, const double value);

    std::vector<std::pair<std::string, std::string>> members; ///< name, JSON
  };
} // namespace selkie
