// Writing of recordings. Whatever the reader would refuse is refused here: each table row is read back before it is
// written.

#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>

#include "drivers/depth_image.hpp"
#include "drivers/perceptron_file.hpp"
#include "drivers/recording.hpp"
#include "drivers/table.hpp"
#include "io/file_bytes.hpp"

namespace scree::drivers {
namespace {

static_assert(std::endian::native == std::endian::little, ".bin frames are written from memory as they are");

/// A text file that grows line by line.
class LineFile {
 public:
  LineFile() = default;
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;
  ~LineFile() {
    if (file_ != nullptr) std::fclose(file_);
  }

  Status open(const std::filesystem::path& path) {
    path_ = path;
    file_ = std::fopen(path.c_str(), "wb");
    if (file_ != nullptr) return {};
    return Error{ErrorKind::cannot_create,
                 fmt::format("{}: cannot be created: {}", path.string(), std::strerror(errno))};
  }
  Status write(const std::string& text) {
    if (file_ != nullptr && std::fwrite(text.data(), 1, text.size(), file_) == text.size()) return {};
    return failed();
  }
  Status close() {
    if (file_ == nullptr) return {};
    const bool flushed = std::fflush(file_) == 0 && std::ferror(file_) == 0;
    const Status status = flushed ? Status{} : failed();
    const bool closed = std::fclose(file_) == 0;
    file_ = nullptr;
    return flushed && !closed ? failed() : status;
  }

 private:
  Status failed() const {
    return Error{ErrorKind::io, fmt::format("{}: writing failed: {}", path_.string(), std::strerror(errno))};
  }
  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
};

Error bad_time(const std::filesystem::path& table, Time previous, Time time) {
  return {ErrorKind::bad_data,
          fmt::format("{}: expected a time above {} s, found {} s", table.string(),
                      format_seconds(previous.time_since_epoch()), format_seconds(time.time_since_epoch()))};
}

/// A directory that is new or empty: what someone recorded before is never mixed with what comes now.
Status claim(const std::filesystem::path& directory) {
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
  std::filesystem::create_directories(directory / "frames", failed);
  if (failed) return refused("cannot be created: " + failed.message());
  return {};
}

}  // namespace

struct RecordingWriter::State {
  std::filesystem::path directory;
  LineFile frames;
  LineFile poses;
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
    if (auto written = io::write_bytes(directory / row.file, bytes); !written) return written;
    if (auto written = frames.write(line); !written) return written;
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
                                                const std::string& recording_yaml) {
  if (const auto claimed = claim(directory); !claimed) return claimed.error();
  const std::span yaml(reinterpret_cast<const std::uint8_t*>(recording_yaml.data()), recording_yaml.size());
  if (const auto written = io::write_bytes(directory / "recording.yaml", yaml); !written) return written.error();
  auto state = std::make_unique<State>();
  state->directory = directory;
  if (const auto opened = state->frames.open(directory / "frames.csv"); !opened) return opened.error();
  if (const auto opened = state->poses.open(directory / "poses.csv"); !opened) return opened.error();
  if (const auto put = state->frames.write(std::string(kFramesHeader) + "\n"); !put) return put.error();
  if (const auto put = state->poses.write(std::string(kPosesHeader) + "\n"); !put) return put.error();
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
  const auto bytes = encode_range_file(file);
  return bytes ? state_->add_frame(*bytes, ".perc", time, sequence) : Status(bytes.error());
}

Status RecordingWriter::add_cloud_frame(const std::vector<Eigen::Vector4f>& points_sensor, Time time,
                                        std::uint64_t sequence) {
  static_assert(sizeof(Eigen::Vector4f) == 16);
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(points_sensor.data()), 16 * points_sensor.size());
  return state_->add_frame(bytes, ".bin", time, sequence);
}

Status RecordingWriter::add_pose(const StampedPose& pose) {
  const auto table = state_->directory / "poses.csv";
  if (state_->last_pose && pose.time <= *state_->last_pose) return bad_time(table, *state_->last_pose, pose.time);
  const std::string line = format_pose_row(pose);
  if (const auto readable = parse_poses_table(std::string(kPosesHeader) + "\n" + line, table.string()); !readable)
    return readable.error();
  if (auto written = state_->poses.write(line); !written) return written;
  state_->last_pose = pose.time;
  return {};
}

Status RecordingWriter::finish() {
  const Status frames = state_->frames.close();
  const Status poses = state_->poses.close();
  return frames ? poses : frames;
}

}  // namespace scree::drivers
