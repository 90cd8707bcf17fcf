#include <selkie/output/statistics.h>

#include <deal.II/base/exceptions.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>

namespace selkie
{
  void
  Statistics::open(const std::string &path, const bool root)
  {
    this->path = path;
    this->root = root;
    if (!root)
      return;
    std::string header;
    if (std::filesystem::is_regular_file(path) &&
        std::getline(std::ifstream(path), header))
      {
        std::istringstream columns(header);
        for (std::string column; std::getline(columns, column, ',');)
          row.emplace_back(column, "");
        has_header = true;
      }
    file.open(path, std::ios::app);
    if (!file)
      throw std::runtime_error("cannot write '" + path +
                               "': " + std::strerror(errno));
  }


  void
  Statistics::end_row()
  {
    if (root && !has_header)
      for (std::size_t i = 0; i < row.size(); ++i)
        file << row[i].first << (i + 1 < row.size() ? ',' : '\n');
    has_header = true;

    for (std::size_t i = 0; i < row.size(); ++i)
      {
        if (root)
          file << (row[i].second.empty() ? "nan" : row[i].second)
               << (i + 1 < row.size() ? ',' : '\n');
        row[i].second.clear();
      }
    next = 0;
    if (!root)
      return;
    // A file that was removed takes rows without complaint.
    if (!file.flush() || !std::filesystem::exists(path))
      throw std::runtime_error("cannot write a row of '" + path +
                               "': " + std::strerror(errno));
  }


  std::string
  Statistics::full_precision(const double value)
  {
    if (std::isnan(value))
      return "nan"; // whatever its sign
    char text[32];
    std::snprintf(text, sizeof(text), "%.17g", value);
    return text;
  }


  void
  Statistics::set_text(const std::string &column, const std::string &value)
  {
    // Columns are nearly always set in their order: look at the next first.
    std::size_t place = next;
    if (place >= row.size() || row[place].first != column)
      for (place = 0; place < row.size(); ++place)
        if (row[place].first == column)
          break;

    if (place == row.size())
      {
        AssertThrow(!has_header,
                    dealii::ExcMessage("the column '" + column + "' of '" +
                                       path + "' was not in its first row"));
        AssertThrow(column.find_first_of(",\"\n") == std::string::npos,
                    dealii::ExcMessage("not a CSV column name: " + column));
        row.emplace_back(column, "");
      }
    row[place].second = value;
    next              = place + 1;
  }


  std::string
  component_column(const std::string &quantity,
                   const unsigned int axis,
                   const std::string &unit)
  {
    return quantity + ' ' + "xyz"[axis] + " (" + unit + ')';
  }
} // namespace selkie
