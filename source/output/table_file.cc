#include <selkie/base/exceptions.h>
#include <selkie/output/files.h>
#include <selkie/output/table_file.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace selkie
{
  namespace
  {
    std::vector<std::string>
    split_row(const std::string &line)
    {
      std::vector<std::string> cells;
      std::istringstream       stream(line);
      for (std::string cell; std::getline(stream, cell, ',');)
        cells.push_back(cell);
      return cells;
    }

    void
    append_row(const std::string &line, TableFile &table)
    {
      const auto cells = split_row(line);
      if (cells.size() != table.columns.size())
        throw std::runtime_error(
          "the row '" + line + "' has " + std::to_string(cells.size()) +
          " values for " + std::to_string(table.columns.size()) + " columns");
      for (std::size_t i = 0; i < cells.size(); ++i)
        try
          {
            table.values[i].push_back(std::stod(cells[i]));
          }
        catch (const std::logic_error &)
          {
            throw std::runtime_error("'" + cells[i] + "' in the column '" +
                                     table.columns[i] + "' is no number");
          }
    }
  } // namespace


  const std::vector<double> *
  TableFile::find(const std::string &column) const
  {
    const auto place = std::find(columns.begin(), columns.end(), column);
    return place == columns.end() ? nullptr : &values[place - columns.begin()];
  }


  TableFile
  read_table(const std::string &path)
  {
    TableFile table;
    table.path = path;
    try
      {
        std::istringstream stream(read_text(path));
        std::string        line;
        std::getline(stream, line);
        table.columns = split_row(line);
        table.values.resize(table.columns.size());
        while (std::getline(stream, line))
          append_row(line, table);
      }
    catch (const std::runtime_error &error)
      {
        throw SceneError("the table '" + path +
                         "' cannot be used: " + error.what());
      }
    return table;
  }


  double
  interpolate(const std::vector<double> &times,
              const std::vector<double> &values,
              const double               t)
  {
    const auto after = std::lower_bound(times.begin(), times.end(), t);
    if (after == times.begin())
      return values.front();
    if (after == times.end())
      return values.back();
    const std::size_t i = after - times.begin();
    if (times[i] == t)
      return values[i];
    const double s = (t - times[i - 1]) / (times[i] - times[i - 1]);
    return (1. - s) * values[i - 1] + s * values[i];
  }


  std::string
  unit_of_column(const std::string &column)
  {
    const auto open = column.rfind('(');
    if (open == std::string::npos || column.back() != ')')
      return "";
    return column.substr(open + 1, column.size() - open - 2);
  }
} // namespace selkie
