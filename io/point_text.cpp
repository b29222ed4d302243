// Text points: x y z with blanks or commas.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <optional>

#include "io/point_collector.hpp"

namespace scree::io {
namespace {

using Fields = std::vector<std::string_view>;

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

/// Columns are apart by blanks, or by one comma or semicolon with blanks around it.
void split(std::string_view line, Fields& fields) {
  fields.clear();
  std::size_t i = 0;
  const auto skip_blanks = [&] {
    while (i < line.size() && is_blank(line[i])) ++i;
  };
  for (skip_blanks(); i < line.size(); skip_blanks()) {
    const std::size_t begin = i;
    while (i < line.size() && !is_blank(line[i]) && line[i] != ',' && line[i] != ';') ++i;
    fields.push_back(line.substr(begin, i - begin));
    skip_blanks();
    if (i < line.size() && (line[i] == ',' || line[i] == ';') && ++i == line.size()) fields.push_back({});
  }
}

/// NaN and infinities are numbers here: they are dropped and counted, not refused.
bool parse_number(std::string_view field, double& value) {
  if (field.size() > 1 && field[0] == '+' && field[1] != '-') field.remove_prefix(1);
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (end != field.data() + field.size()) return false;
  if (status == std::errc::result_out_of_range) value = std::nan("");
  return status != std::errc::invalid_argument;
}

struct Columns {
  std::size_t x = 0, y = 1, z = 2;
  std::optional<std::size_t> intensity;
  std::size_t count = 0;
};

/// "x", "X", "\"x\"" and "x_m" are all x.
std::string plain_name(std::string_view field) {
  std::string name;
  for (const char c : field)
    if (c != '"' && c != '\'') name += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  if (name.size() > 2 && name.ends_with("_m")) name.resize(name.size() - 2);
  return name;
}

Result<Columns> columns_from_names(const Fields& fields) {
  Columns columns;
  columns.count = fields.size();
  std::array<std::optional<std::size_t>, 3> place;
  std::string found;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::string name = plain_name(fields[i]);
    if (found.size() < 80) found.append(i == 0 ? "" : ",").append(name, 0, 20);
    if (name == "x" || name == "y" || name == "z") {
      if (place[static_cast<std::size_t>(name[0] - 'x')])
        return Error{ErrorKind::bad_data, "column '" + name + "' is named twice"};
      place[static_cast<std::size_t>(name[0] - 'x')] = i;
    }
    if (name == "intensity" || name == "i" || name == "reflectance") columns.intensity = i;
  }
  std::replace_if(
      found.begin(), found.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  if (!place[0] || !place[1] || !place[2])
    return Error{ErrorKind::bad_data,
                 fmt::format("expected numbers x y z, or a header that names x, y and z, found '{}'", found)};
  columns.x = *place[0];
  columns.y = *place[1];
  columns.z = *place[2];
  return columns;
}

Result<Columns> columns_from_first_row(const Fields& fields) {
  double ignored = 0.0;
  if (!parse_number(fields[0], ignored)) return columns_from_names(fields);
  if (fields.size() < 3)
    return Error{ErrorKind::bad_data, fmt::format("expected at least 3 columns, found {}", fields.size())};
  Columns columns;
  columns.count = fields.size();
  if (fields.size() == 4) columns.intensity = 3;
  return columns;
}

Status take_row(const Fields& fields, const Columns& columns, PointCollector& points) {
  if (fields.size() != columns.count)
    return Error{ErrorKind::bad_data,
                 fmt::format("expected {} columns like the first line, found {}", columns.count, fields.size())};
  Eigen::Vector3d position;
  double intensity = 0.0;
  const std::array<std::pair<std::size_t, double*>, 4> wanted{{{columns.x, &position.x()},
                                                               {columns.y, &position.y()},
                                                               {columns.z, &position.z()},
                                                               {columns.intensity.value_or(columns.x), &intensity}}};
  for (const auto& [column, value] : wanted)
    if (!parse_number(fields[column], *value)) {
      std::string found(fields[column].substr(0, 40));
      std::replace_if(
          found.begin(), found.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
      return Error{ErrorKind::bad_data, fmt::format("expected a number in column {}, found '{}'", column + 1, found)};
    }
  points.add(position, columns.intensity ? intensity : 0.0);
  return {};
}

}  // namespace

Result<PointCloud> parse_point_text(std::string_view text, const std::string& name, std::size_t first_line) {
  PointCollector points;
  std::optional<Columns> columns;
  Fields fields;
  for (std::size_t number = first_line; !text.empty(); ++number) {
    const auto* end = static_cast<const char*>(std::memchr(text.data(), '\n', text.size()));
    const std::string_view line =
        text.substr(0, end == nullptr ? text.size() : static_cast<std::size_t>(end - text.data()));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    split(line, fields);
    if (fields.empty() || fields[0].starts_with('#') || fields[0].starts_with("//")) continue;
    const auto at_line = [&](const Error& error) {
      return Error{error.kind, fmt::format("{}:{}: {}", name, number, error.message)};
    };
    if (!columns) {
      const auto found = columns_from_first_row(fields);
      if (!found) return at_line(found.error());
      columns = *found;
      double ignored = 0.0;
      if (!parse_number(fields[0], ignored)) continue;  // it was the header
    }
    if (const auto taken = take_row(fields, *columns, points); !taken) return at_line(taken.error());
  }
  return std::move(points).finish(name);
}

}  // namespace scree::io
