// Writing of recordings. Whatever the reader would refuse is refused here: each table row is read back before it is
// written.

#include <bit>
#include <fmt/format.h>
#include <utility>

#include "drivers/depth_image.hpp"
#include "drivers/line_file.hpp"
#include "drivers/perceptron_file.hpp"
#include "drivers/recording.hpp"
#include "drivers/table.hpp"
#include "io/file_bytes.hpp"

namespace scree::drivers {
namespace {

static_assert(std::endian::native == std::endian::little, ".bin frames are written from memory as they are");

Error bad_time(const std::filesystem::path& table, Time previous, Time time) {
  return {ErrorKind::bad_data,
          fmt::format("{}: expected a time above {} s, found {} s", table.string(),
                      format_seconds(previous.time_since_epoch()), format_seconds(time.time_since_epoch()))};
}

}  // namespace

Status claim_directory(const std::filesystem::path& directory) {
  const auto refused = [&](const std::string& what) {
    return Error{ErrorKind::cannot_create, fmt::format("{}: {}", directory.string(), what)};
  };
  std::error_code failed;
  if (std::filesystem::exists(directory, failed)) {
    if (!std::filesystem::is_directory(directory, failed))
      return refused("expected a directory to record into, found a file");
    const bool empty = std::filesystem::is_empty(directory, failed);
    if (failed) return refused("cannot be listed: " + failed.message());
    if (!empty) return refused("expected a new or empty directory to record into, found one that holds files");
  }
  std::filesystem::create_directories(directory, failed);
  if (failed) return refused("cannot be created: " + failed.message());
  return {};
}

struct RecordingWriter::State {
  std::filesystem::path directory;
  LineFile frames;
  LineFile poses;
  PoseErrors pose_errors = PoseErrors::unknown;
  std::size_t frame_count = 0;
  std::optional<Time> last_frame;
  std::optional<Time> last_pose;

  /// The file first, then its row: a recording that breaks off never names a frame that it does not hold.
  Status add_frame(std::span<const std::uint8_t> bytes, const char* extension, Time time, std::uint64_t sequence) {
    const auto table = directory / "frames.csv";
    if (last_frame && time <= *last_frame) return bad_time(table, *last_frame, time);
    const FrameRow row{fmt::format("frames/{:06}{}", frame_count, extension), time, sequence};
    const std::string line = format_frame_row(row);
    if (const auto readable = parse_frames_table(std::string(kFramesHeader) + "\n" + line, table.string()); !readable)
      return readable.error();
    Status written = io::write_bytes(directory / row.file, bytes);
    if (written) written = frames.write(line);
    if (!written) {  // a part of a frame is of no use, and the disk may be full
      std::error_code ignored;
      std::filesystem::remove(directory / row.file, ignored);
      return written;
    }
    last_frame = time;
    ++frame_count;
    return {};
  }
};

RecordingWriter::RecordingWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;
RecordingWriter& RecordingWriter::operator=(RecordingWriter&&) noexcept = default;
RecordingWriter::~RecordingWriter() = default;

Result<RecordingWriter> RecordingWriter::create(const std::filesystem::path& directory,
                                                const std::string& recording_yaml, PoseErrors pose_errors) {
  if (const auto claimed = claim_directory(directory); !claimed) return claimed.error();
  std::error_code failed;
  std::filesystem::create_directories(directory / "frames", failed);
  if (failed)
    return Error{ErrorKind::cannot_create,
                 fmt::format("{}: cannot be created: {}", (directory / "frames").string(), failed.message())};
  const std::span yaml(reinterpret_cast<const std::uint8_t*>(recording_yaml.data()), recording_yaml.size());
  if (const auto written = io::write_bytes(directory / "recording.yaml", yaml); !written) return written.error();
  auto state = std::make_unique<State>();
  state->directory = directory;
  state->pose_errors = pose_errors;
  const std::string_view poses = pose_errors == PoseErrors::recorded ? kUncertainPosesHeader : kPosesHeader;
  if (const auto opened = state->frames.open(directory / "frames.csv"); !opened) return opened.error();
  if (const auto opened = state->poses.open(directory / "poses.csv"); !opened) return opened.error();
  if (const auto put = state->frames.write(std::string(kFramesHeader) + "\n"); !put) return put.error();
  if (const auto put = state->poses.write(std::string(poses) + "\n"); !put) return put.error();
  return RecordingWriter(std::move(state));
}

Status RecordingWriter::add_raw_frame(ProjectionKind kind, const Grid<std::uint16_t>& raw, Time time,
                                      std::uint64_t sequence) {
  if (kind == ProjectionKind::cloud)
    return Error{ErrorKind::internal, "recording: expected points for a frame of projection cloud, found raw counts"};
  if (kind == ProjectionKind::pinhole || kind == ProjectionKind::spherical) {
    const auto bytes = encode_depth_image(raw);
    return bytes ? state_->add_frame(*bytes, ".pgm", time, sequence) : Status(bytes.error());
  }
  RangeFile file;
  const bool cmu = kind == ProjectionKind::perceptron_cmu && raw.rows() == kCmuSide && raw.columns() == kCmuSide;
  file.layout = cmu ? RangeFileLayout::cmu_words : RangeFileLayout::usf;  // other sizes need the header to be known
  file.raw = raw;
  return add_range_file(file, 0, time, sequence);
}

Status RecordingWriter::add_range_file(const RangeFile& file, int shift, Time time, std::uint64_t sequence) {
  const auto bytes = encode_range_file(file, shift);
  return bytes ? state_->add_frame(*bytes, ".perc", time, sequence) : Status(bytes.error());
}

Status RecordingWriter::add_cloud_frame(const std::vector<Eigen::Vector4f>& points_sensor, Time time,
                                        std::uint64_t sequence) {
  static_assert(sizeof(Eigen::Vector4f) == 16);
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(points_sensor.data()), 16 * points_sensor.size());
  return state_->add_frame(bytes, ".bin", time, sequence);
}

Status RecordingWriter::add_pose(const StampedPose& pose) {
  return add_poses(std::span(&pose, 1), {});
}

Status RecordingWriter::add_poses(std::span<const StampedPose> poses, const PoseVariance& variance) {
  const auto table = state_->directory / "poses.csv";
  const bool uncertain = state_->pose_errors == PoseErrors::recorded;
  std::string lines;
  std::optional<Time> last = state_->last_pose;
  for (const StampedPose& pose : poses) {
    if (last && pose.time <= *last) return bad_time(table, *last, pose.time);
    last = pose.time;
    lines += uncertain ? format_uncertain_pose_row(pose, variance) : format_pose_row(pose);
  }
  const std::string header(uncertain ? kUncertainPosesHeader : kPosesHeader);
  if (const auto readable = parse_poses_table(header + "\n" + lines, table.string()); !readable)
    return readable.error();
  if (auto written = state_->poses.write(lines); !written) return written;
  state_->last_pose = last;
  return {};
}

std::optional<Time> RecordingWriter::last_frame() const {
  return state_->last_frame;
}
std::optional<Time> RecordingWriter::last_pose() const {
  return state_->last_pose;
}
std::size_t RecordingWriter::frame_count() const {
  return state_->frame_count;
}

Status RecordingWriter::finish() {
  const Status frames = state_->frames.close();
  const Status poses = state_->poses.close();
  return frames ? poses : frames;
}

}  // namespace scree::drivers
