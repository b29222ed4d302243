#pragma once
// The tables of a recording: frames.csv and poses.csv. Strict: a table that is not what it should be is refused whole,
// with file and line, before any frame is mapped with it.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/time.hpp"
#include "drivers/frame/pose_track.hpp"
#include "drivers/frame/range_frame.hpp"

namespace scree::drivers {

inline constexpr std::size_t kTableMaxBytes = std::size_t{1} << 30;
inline constexpr double kTableMaxSeconds = 4e9;       ///< |t_s|: differences of two times fit 64-bit nanoseconds
inline constexpr double kTableMaxCoordinate_m = 1e8;  ///< |x_m|, |y_m|, |z_m| of a pose

inline constexpr std::string_view kFramesHeader = "file,t_s,sequence";
inline constexpr std::string_view kPosesHeader = "t_s,x_m,y_m,z_m,qx,qy,qz,qw";
/// Of poses whose source tells how well it knows them: variances of position and of small rotations, map axes.
inline constexpr std::string_view kUncertainPosesHeader =
    "t_s,x_m,y_m,z_m,qx,qy,qz,qw,var_x_m2,var_y_m2,var_z_m2,var_roll_rad2,var_pitch_rad2,var_yaw_rad2";
inline constexpr std::string_view kOrderHeader = "recording,frame";  ///< order.csv of several recordings

/// Calls `row(line_number, fields)` for each line of comma-separated `text` behind the header, which must equal
/// `header`; blanks around fields are removed, CR LF and empty lines at the end are accepted. Stops at the first error.
/// A last line without an end is what a writer that was killed leaves: with `torn` it is left out, and `torn` says so,
/// when it cannot be read; with must_end, for tables that only this program writes, always, because half a number may
/// be a number. Errors: bad_data "name:line: expected …, found …".
enum class LastLine : std::uint8_t { may_end, must_end };
using TableRow = std::function<Status(std::size_t line, std::span<const std::string_view> fields)>;
Status parse_table(std::string_view text, const std::string& name, std::string_view header, const TableRow& row,
                   std::string* torn = nullptr, LastLine last_line = LastLine::may_end);

/// A finite decimal; nothing else in the field. The error carries no place: callers prepend it.
Result<double> parse_number(std::string_view field);

/// One line of frames.csv. `file` is relative to the recording and lies inside frames/ (a bare name is taken to).
struct FrameRow {
  std::string file;
  Time time;  ///< of row 0
  std::uint64_t sequence = 0;
};

/// Times increase strictly, paths do not leave `folder`; an empty `folder` means the recording itself.
Result<std::vector<FrameRow>> parse_frames_table(std::string_view text, const std::string& name,
                                                 std::string_view folder = "frames", std::string* torn = nullptr);

/// T_map_body per line: times increase strictly, numbers are finite, quaternions of norm 1 ± 1e-3; at least one pose.
Result<std::vector<StampedPose>> parse_poses_table(std::string_view text, const std::string& name,
                                                   std::string* torn = nullptr);

/// The same with what the table says of their errors: `variances` is empty or one a pose.
struct PosesTable {
  std::vector<StampedPose> poses;
  std::vector<PoseVariance> variances;
};
Result<PosesTable> parse_uncertain_poses_table(std::string_view text, const std::string& name,
                                               std::string* torn = nullptr);

/// order.csv: in which order the frames of several recordings belong. Recordings are plain folder names.
struct OrderRow {
  std::string recording;
  std::uint64_t frame = 0;  ///< place in that recording's frames.csv, from 0
};
Result<std::vector<OrderRow>> parse_order_table(std::string_view text, const std::string& name,
                                                std::string* torn = nullptr);

/// One line each, with line end, in digits that read back to the same values.
std::string format_frame_row(const FrameRow& row);
std::string format_pose_row(const StampedPose& pose);
std::string format_uncertain_pose_row(const StampedPose& pose, const PoseVariance& variance);
std::string format_order_row(const OrderRow& row);

}  // namespace scree::drivers
