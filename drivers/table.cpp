#include "drivers/table.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace scree::drivers {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

void split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

std::string joined(const std::vector<std::string_view>& fields) {
  std::string text;
  for (const std::string_view field : fields) text.append(text.empty() ? "" : ",").append(field);
  return text;
}

Error at_line(const std::string& name, std::size_t line, const std::string& what) {
  return {ErrorKind::bad_data, fmt::format("{}:{}: {}", name, line, what)};
}

std::string shown(std::string_view field) {
  std::string text(field.substr(0, 80));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

/// Exact nanoseconds, within what a recording may span.
Result<Time> parse_time(std::string_view field) {
  const auto duration = parse_seconds(field);
  if (!duration || std::abs(to_seconds(*duration)) > kTableMaxSeconds)
    return Error{ErrorKind::bad_data,
                 fmt::format("expected t_s in decimal seconds within ±4e9, found '{}'", shown(field))};
  return Time(*duration);
}

/// Empty when `file` is fine, or what is wrong with it. Plain components only: nothing absolute, nothing upwards.
std::string path_fault(std::string_view file) {
  if (file.empty()) return "an empty name";
  if (file.front() == '/') return "an absolute path";
  if (file.find_first_of(std::string_view("\\\0", 2)) != std::string_view::npos) return "a backslash or NUL";
  for (std::string_view rest = file;;) {
    const std::size_t slash = rest.find('/');
    const std::string_view part = rest.substr(0, slash);
    if (part == "..") return "'..'";
    if (part.empty() || part == ".") return "an empty component";
    if (slash == std::string_view::npos) return {};
    rest.remove_prefix(slash + 1);
  }
}

Result<std::uint64_t> parse_count(std::string_view field, const char* what) {
  std::uint64_t count = 0;
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), count);
  if (status != std::errc{} || end != field.data() + field.size())
    return Error{ErrorKind::bad_data, fmt::format("expected {}, found '{}'", what, shown(field))};
  return count;
}

Result<FrameRow> parse_frame_row(std::span<const std::string_view> fields, std::string_view folder) {
  FrameRow row;
  if (const std::string fault = path_fault(fields[0]); !fault.empty())
    return Error{ErrorKind::bad_data,
                 fmt::format("expected a path inside {}, found {} in '{}'",
                             folder.empty() ? "the recording" : std::string(folder) + "/", fault, shown(fields[0]))};
  row.file = fields[0];
  const std::string prefix = folder.empty() ? std::string() : std::string(folder) + "/";
  if (row.file.find('/') == std::string::npos) row.file.insert(0, prefix);
  if (row.file.compare(0, prefix.size(), prefix) != 0)
    return Error{ErrorKind::bad_data, fmt::format("expected a path inside {}, found '{}'", prefix, shown(fields[0]))};
  const auto time = parse_time(fields[1]);
  if (!time) return time.error();
  row.time = *time;
  const auto sequence = parse_count(fields[2], "an unsigned sequence");
  if (!sequence) return sequence.error();
  row.sequence = *sequence;
  return row;
}

Result<StampedPose> parse_pose_row(std::span<const std::string_view> fields) {
  constexpr std::array<const char*, 8> kNames{"t_s", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"};
  const auto time = parse_time(fields[0]);
  if (!time) return time.error();
  std::array<double, 8> value{};
  for (std::size_t i = 1; i < value.size(); ++i) {
    const auto number = parse_number(fields[i]);
    if (!number) return Error{ErrorKind::bad_data, fmt::format("{}: {}", kNames[i], number.error().message)};
    value[i] = *number;
    if (i < 4 && std::abs(value[i]) > kTableMaxCoordinate_m)
      return Error{ErrorKind::bad_data, fmt::format("{}: expected at most {:g} m, found {}", kNames[i],
                                                    kTableMaxCoordinate_m, shown(fields[i]))};
  }
  const Eigen::Quaterniond rotation(value[7], value[4], value[5], value[6]);
  if (!(std::abs(rotation.norm() - 1.0) <= 1e-3))
    return Error{ErrorKind::bad_data,
                 fmt::format("expected a quaternion of norm 1 ± 0.001, found {}", rotation.norm())};
  return StampedPose{*time, Pose{{value[1], value[2], value[3]}, rotation}};
}

Result<PoseVariance> parse_variance(std::span<const std::string_view> fields) {
  PoseVariance variance;
  for (int i = 0; i < 6; ++i) {
    const std::string_view field = fields[static_cast<std::size_t>(i)];
    const auto number = parse_number(field);
    if (!number || *number < 0.0)
      return Error{ErrorKind::bad_data, fmt::format("expected a variance of at least 0, found '{}'", shown(field))};
    (i < 3 ? variance.position_m2[i] : variance.attitude_rad2[i - 3]) = *number;
  }
  return variance;
}

Status check_increasing(Time previous, Time time) {
  if (time > previous) return {};
  return Error{ErrorKind::bad_data,
               fmt::format("expected t_s above {}, found {}: times must increase",
                           format_seconds(previous.time_since_epoch()), format_seconds(time.time_since_epoch()))};
}

}  // namespace

Result<double> parse_number(std::string_view field) {
  double value = 0.0;
  if (field.size() > 1 && field[0] == '+' && field[1] != '-') field.remove_prefix(1);
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (status != std::errc{} || end != field.data() + field.size() || !std::isfinite(value))
    return Error{ErrorKind::bad_data, fmt::format("expected a finite number, found '{}'", shown(field))};
  return value;
}

Status parse_table(std::string_view text, const std::string& name, std::string_view header, const TableRow& row,
                   std::string* torn, LastLine last_line) {
  std::vector<std::string_view> expected, fields;
  split(header, expected);
  std::size_t empty_line = 0;
  for (std::size_t line = 1; line == 1 || !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    const bool may_be_torn = torn != nullptr && end == std::string_view::npos && line > 1;
    split(text.substr(0, end), fields);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line == 1) {
      if (fields != expected)
        return at_line(name, 1, fmt::format("expected the header '{}', found '{}'", header, shown(joined(fields))));
      continue;
    }
    if (fields.size() == 1 && fields[0].empty()) {
      if (empty_line == 0) empty_line = line;
      continue;
    }
    if (empty_line != 0) return at_line(name, empty_line, "expected a row, found an empty line");
    if (may_be_torn && last_line == LastLine::must_end) {
      *torn = fmt::format("{}:{}: the last line has no end and is left out", name, line);
      continue;
    }
    Status taken = Error{ErrorKind::bad_data,
                         fmt::format("expected {} columns ({}), found {}", expected.size(), header, fields.size())};
    if (fields.size() == expected.size()) taken = row(line, fields);
    if (taken) continue;
    if (!may_be_torn) return at_line(name, line, taken.error().message);
    *torn = fmt::format("{}:{}: the last line has no end and is left out: {}", name, line, taken.error().message);
  }
  return {};
}

Result<std::vector<FrameRow>> parse_frames_table(std::string_view text, const std::string& name,
                                                 std::string_view folder, std::string* torn) {
  std::vector<FrameRow> rows;
  const auto parsed = parse_table(
      text, name, kFramesHeader,
      [&](std::size_t, auto fields) -> Status {
        auto row = parse_frame_row(fields, folder);
        if (!row) return row.error();
        if (!rows.empty())
          if (const auto increasing = check_increasing(rows.back().time, row->time); !increasing) return increasing;
        rows.push_back(std::move(*row));
        return {};
      },
      torn);
  if (!parsed) return parsed.error();
  if (rows.empty()) return at_line(name, 2, "expected at least one frame, found none");
  return rows;
}

Result<PosesTable> parse_uncertain_poses_table(std::string_view text, const std::string& name, std::string* torn) {
  PosesTable table;
  const bool uncertain = text.substr(0, text.find('\n')).find("var_") != std::string_view::npos;
  const auto take = [&](std::size_t, std::span<const std::string_view> fields) -> Status {
    const auto pose = parse_pose_row(fields.first(8));
    if (!pose) return pose.error();
    if (!table.poses.empty())
      if (const auto increasing = check_increasing(table.poses.back().time, pose->time); !increasing) return increasing;
    if (uncertain) {
      const auto variance = parse_variance(fields.subspan(8));
      if (!variance) return variance.error();
      table.variances.push_back(*variance);
    }
    table.poses.push_back(*pose);
    return {};
  };
  const auto parsed = parse_table(text, name, uncertain ? kUncertainPosesHeader : kPosesHeader, take, torn,
                                  uncertain ? LastLine::must_end : LastLine::may_end);
  if (!parsed) return parsed.error();
  if (table.poses.empty()) return at_line(name, 2, "expected at least one pose, found none");
  return table;
}

Result<std::vector<StampedPose>> parse_poses_table(std::string_view text, const std::string& name, std::string* torn) {
  auto table = parse_uncertain_poses_table(text, name, torn);
  if (!table) return table.error();
  return std::move(table->poses);
}

Result<std::vector<OrderRow>> parse_order_table(std::string_view text, const std::string& name, std::string* torn) {
  std::vector<OrderRow> rows;
  const auto take = [&](std::size_t, std::span<const std::string_view> fields) -> Status {
    if (const std::string fault = path_fault(fields[0]);
        !fault.empty() || fields[0].find('/') != std::string_view::npos)
      return Error{ErrorKind::bad_data, fmt::format("expected the name of a folder, found '{}'", shown(fields[0]))};
    const auto frame = parse_count(fields[1], "the place of a frame");
    if (!frame) return frame.error();
    rows.push_back({std::string(fields[0]), *frame});
    return {};
  };
  if (const auto parsed = parse_table(text, name, kOrderHeader, take, torn, LastLine::must_end); !parsed)
    return parsed.error();
  if (rows.empty()) return at_line(name, 2, "expected at least one frame, found none");
  return rows;
}

std::string format_frame_row(const FrameRow& row) {
  return fmt::format("{},{},{}\n", row.file, format_seconds(row.time.time_since_epoch()), row.sequence);
}

std::string format_pose_row(const StampedPose& pose) {  // fmt's {} gives the shortest digits that read back exactly
  const auto& t = pose.T_map_body.translation_m;
  const auto& q = pose.T_map_body.rotation;
  return fmt::format("{},{},{},{},{},{},{},{}\n", format_seconds(pose.time.time_since_epoch()), t.x(), t.y(), t.z(),
                     q.x(), q.y(), q.z(), q.w());
}

std::string format_uncertain_pose_row(const StampedPose& pose, const PoseVariance& variance) {
  std::string row = format_pose_row(pose);
  row.pop_back();
  const auto& p = variance.position_m2;
  const auto& a = variance.attitude_rad2;
  return row + fmt::format(",{},{},{},{},{},{}\n", p.x(), p.y(), p.z(), a.x(), a.y(), a.z());
}

std::string format_order_row(const OrderRow& row) {
  return fmt::format("{},{}\n", row.recording, row.frame);
}

}  // namespace scree::drivers
