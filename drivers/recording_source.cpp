#include "drivers/recording_source.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "drivers/frame_pool.hpp"
#include "drivers/recording_frame.hpp"
#include "drivers/table.hpp"
#include "io/file_bytes.hpp"

namespace scree::drivers {
namespace {

std::string seconds(Time time) {
  return format_seconds(time.time_since_epoch());
}

/// Why there is no pose at `time`: "the poses cover …".
std::string coverage(const PoseTrack& poses, Time time) {
  if (const auto gap = poses.gap_at(time))
    return fmt::format("the poses around it, at {} and {} s, are more than {} s apart and differ", seconds(gap->before),
                       seconds(gap->after), format_seconds(PoseTrack::kMaxGap));
  if (poses.poses().size() == 1) return fmt::format("the poses cover {} s only", seconds(poses.begin()));
  return fmt::format("the poses cover {} to {} s", seconds(poses.begin()), seconds(poses.end()));
}

class FileSource final : public Source {
 public:
  explicit FileSource(FileSourceSetup setup)
      : setup_(std::move(setup)),
        sensor_(std::make_shared<const SensorConfig>(setup_.sensor)),
        reader_(setup_.sensor) {}

  /// Files never make anyone wait: the timeout is not used.
  Result<SourceEvent> next(std::chrono::milliseconds) override {
    if (!setup_.remark.empty())
      return SourceEvent{SourceEvent::Kind::notice, nullptr, std::exchange(setup_.remark, {})};
    if (next_ == setup_.frames.size()) return finished();
    const FrameEntry& entry = setup_.frames[next_++];
    const std::shared_ptr<RangeFrame> frame = pool_.take();
    std::string warning;
    if (const auto read = reader_.read(entry.file, *frame, warning); !read) {
      if (read.error().kind == ErrorKind::unavailable) return read.error();
      return skipped(read.error().message);
    }
    if (const auto placed = place(entry, *frame); !placed) return skipped(placed.error().message);
    ++good_;
    return SourceEvent{SourceEvent::Kind::frame, frame, std::move(warning)};
  }

  Origin origin() const override { return Origin::replay; }
  std::string name() const override { return setup_.name; }
  std::optional<std::size_t> frame_count() const override { return setup_.frames.size(); }

 private:
  /// Stamps every row and gives it the robot's pose at that time.
  Status place(const FrameEntry& entry, RangeFrame& frame) const {
    const auto rows = static_cast<std::size_t>(frame.range_m.rows());
    const Duration period = setup_.sensor.row_period;
    frame.sensor = sensor_;
    frame.sequence = entry.sequence;
    frame.time = entry.time;
    frame.row_time.resize(rows);
    frame.T_map_body.resize(rows);
    for (std::size_t r = 0; r < rows; ++r) {
      frame.row_time[r] = entry.time + period * static_cast<std::int64_t>(r);
      if (r > 0 && period == Duration::zero()) {
        frame.T_map_body[r] = frame.T_map_body[0];
        continue;
      }
      const auto pose = setup_.poses.at(frame.row_time[r]);
      if (!pose)
        return Error{ErrorKind::bad_data,
                     fmt::format("{}: expected a pose at {} s (row {}), {}", entry.file.string(),
                                 seconds(frame.row_time[r]), r, coverage(setup_.poses, frame.row_time[r]))};
      frame.T_map_body[r] = *pose;
    }
    frame.pose_variance = variance_at(frame.row_time.back());
    frame.received = MonotonicClock::now();
    return {};
  }

  /// Linear between the poses around `time`, which lies within them.
  PoseVariance variance_at(Time time) const {
    if (setup_.variances.empty()) return {};
    const auto& poses = setup_.poses.poses();
    const auto after = std::upper_bound(poses.begin(), poses.end(), time,
                                        [](Time t, const StampedPose& pose) { return t < pose.time; });
    const auto i = static_cast<std::size_t>(after - poses.begin()) - 1;
    const PoseVariance& a = setup_.variances[i];
    if (after == poses.end() || poses[i].time == time) return a;
    const double weight = to_seconds(time - poses[i].time) / to_seconds(after->time - poses[i].time);
    const PoseVariance& b = setup_.variances[i + 1];
    return {a.position_m2 + weight * (b.position_m2 - a.position_m2),
            a.attitude_rad2 + weight * (b.attitude_rad2 - a.attitude_rad2)};
  }

  SourceEvent skipped(std::string message) {
    last_fault_ = message;
    return {SourceEvent::Kind::skipped, nullptr, std::move(message)};
  }

  Result<SourceEvent> finished() const {
    if (good_ > 0) return SourceEvent{SourceEvent::Kind::end_of_stream, nullptr, {}};
    return Error{ErrorKind::bad_data, fmt::format("{}: expected at least one good frame, found none among {}; {}",
                                                  setup_.name, setup_.frames.size(), last_fault_)};
  }

  FileSourceSetup setup_;
  std::shared_ptr<const SensorConfig> sensor_;
  RecordedFrameReader reader_;
  FramePool pool_;
  std::size_t next_ = 0;
  std::size_t good_ = 0;
  std::string last_fault_;
};

/// Times lie within ±4e9 s (kTableMaxSeconds), so their differences do not overflow.
std::vector<FrameEntry> in_window(const std::vector<FrameEntry>& frames, const ReplayWindow& window) {
  std::vector<FrameEntry> kept;
  for (const FrameEntry& frame : frames) {
    const Duration elapsed = frame.time - frames.front().time;
    const Duration start = std::max(window.start, Duration::zero());
    if (elapsed >= start && (!window.duration || elapsed - start < *window.duration)) kept.push_back(frame);
  }
  return kept;
}

}  // namespace

Result<std::unique_ptr<Source>> make_file_source(FileSourceSetup setup, const ReplayWindow& window) {
  if (setup.frames.empty()) return Error{ErrorKind::bad_data, setup.name + ": expected at least one frame, found none"};
  const Time first = setup.frames.front().time;
  const Time last = setup.frames.back().time;
  setup.frames = in_window(setup.frames, window);
  if (setup.frames.empty())
    return Error{ErrorKind::usage, fmt::format("{}: no frame in the chosen window: the recording's frames span {} s",
                                               setup.name, format_seconds(last - first))};
  const auto covered = [&](const FrameEntry& frame) { return setup.poses.at(frame.time).has_value(); };
  if (std::none_of(setup.frames.begin(), setup.frames.end(), covered))
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected poses at the times of the frames, {} to {} s; {}, no frame", setup.name,
                             seconds(setup.frames.front().time), seconds(setup.frames.back().time),
                             coverage(setup.poses, setup.frames.front().time))};
  return std::unique_ptr<Source>(std::make_unique<FileSource>(std::move(setup)));
}

Result<std::string> read_table_text(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  if (const auto read = io::read_bytes(file, kTableMaxBytes, bytes); !read) return read.error();
  return std::string(io::as_text(bytes));
}

Result<RecordedTrack> read_pose_track(const std::filesystem::path& file) {
  const auto text = read_table_text(file);
  if (!text) return text.error();
  RecordedTrack track;
  auto table = parse_uncertain_poses_table(*text, file.string(), &track.torn);
  if (!table) return table.error();
  auto poses = PoseTrack::make(std::move(table->poses));
  if (!poses) return poses.error();
  track.poses = *std::move(poses);
  track.variances = std::move(table->variances);
  return track;
}

Result<std::vector<std::filesystem::path>> list_files(const std::filesystem::path& directory,
                                                      const std::string& extension) {
  std::error_code failed;
  if (!std::filesystem::is_directory(directory, failed))
    return Error{ErrorKind::no_input, directory.string() + ": expected a directory, found none"};
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator entry(directory, failed), end; !failed && entry != end;
       entry.increment(failed))
    if (entry->path().extension() == extension) files.push_back(entry->path());
  if (failed)
    return Error{ErrorKind::io, fmt::format("{}: cannot be listed: {}", directory.string(), failed.message())};
  if (files.empty())
    return Error{ErrorKind::bad_data, fmt::format("{}: expected *{} files, found none", directory.string(), extension)};
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace scree::drivers
