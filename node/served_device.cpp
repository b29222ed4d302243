#include "node/served_device.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <spdlog/spdlog.h>
#include <utility>

#include "node/progress.hpp"
#include "node/served_device_state.hpp"

namespace scree::node {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kRest{2};  // between two rounds of serving
constexpr Duration kPoseOutPeriod = milliseconds(20);
constexpr int kRowsBetweenRounds = 4;

/// Rendering in pieces between which the rest of the device is served.
class ServingExecutor final : public Executor {
 public:
  explicit ServingExecutor(std::function<void()> serve) : serve_(std::move(serve)) {}
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    for (int begin = 0; begin < count; begin += kRowsBetweenRounds) {
      body(begin, std::min(begin + kRowsBetweenRounds, count));
      serve_();
    }
  }

 private:
  std::function<void()> serve_;
};

Time wall_clock() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

/// The counts as they lie in memory: 16-bit little-endian, row-major.
drivers::SharedBytes image_of(const Grid<std::uint16_t>& raw) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(raw.data());
  return std::make_shared<const std::vector<std::uint8_t>>(bytes, bytes + 2 * raw.size());
}

}  // namespace

Time ServedDevice::State::now() const {
  if (!began) return simulator.frame_time(0);
  return simulator.frame_time(0) + std::chrono::duration_cast<Duration>(MonotonicClock::now() - *began);
}

void ServedDevice::State::begin() {
  began = MonotonicClock::now();
  epoch = wall_clock() - simulator.frame_time(0);
}

/// One round: everything but rendering.
void ServedDevice::State::serve() {
  server->serve();
  inject_faults();
  take_commands();
  if (began) {
    way->advance_to(now());
    note_poses();
  }
}

void ServedDevice::State::inject_faults() {
  if (!faults) return;
  if (!first_reader && server->readers() > 0) first_reader = MonotonicClock::now();
  if (!first_reader) return;
  const auto since = std::chrono::duration_cast<Duration>(MonotonicClock::now() - *first_reader);
  for (const drivers::Fault& fault : faults->advance(since, *server))
    spdlog::warn("fault of line {}: {} at {:.3f} s", fault.line, to_string(fault.kind), to_seconds(since));
}

void ServedDevice::State::take_commands() {
  if (!drive_socket) return;
  const auto received =
      drive_socket->receive(milliseconds(0), [this](std::span<const std::uint8_t> datagram, const Endpoint&) {
        if (const auto command = commands.accept(datagram))
          robot->command(static_cast<double>(command->speed_mps), static_cast<double>(command->curvature_per_m), now());
      });
  if (!received && !error) error = received.error();
}

/// Everything that wants to know where the robot is, up to now.
void ServedDevice::State::note_poses() {
  const auto& truth = way->truth();
  const Time until = now();
  auto at = std::upper_bound(truth.begin(), truth.end(), noted,
                             [](Time time, const StampedPose& pose) { return time < pose.time; });
  for (; at != truth.end() && at->time <= until; ++at) {
    noted = at->time;
    ground.add(at->T_map_body);
    if (track.is_open()) track << drivers::format_pose_row({at->time + epoch, at->T_map_body});
  }
  if (noted < next_pose_out || pose_outputs.empty()) return;
  const auto& odometry = way->odometry();
  const auto newest = std::upper_bound(odometry.begin(), odometry.end(), until,
                                       [](Time time, const StampedPose& pose) { return time < pose.time; });
  if (newest == odometry.begin()) return;
  const StampedPose pose{(newest - 1)->time + epoch, (newest - 1)->T_map_body};
  for (PoseOutput& output : pose_outputs) output.send(pose);
  next_pose_out = (newest - 1)->time + kPoseOutPeriod;
}

bool ServedDevice::State::stopped() {
  if (!interrupted && signals.wait(milliseconds(0))) interrupted = true;
  return interrupted || error || (began && options.duration && now() - simulator.frame_time(0) >= *options.duration);
}

/// Serves until `reached`; false when the device is to stop.
bool ServedDevice::State::serve_until(const std::function<bool()>& reached) {
  for (;;) {
    serve();
    if (stopped()) return false;
    if (reached()) return true;
    if (signals.wait(kRest)) interrupted = true;
  }
}

/// Sends a trajectory's last frame to its end, as long as somebody takes it.
void ServedDevice::State::drain() {
  const auto limit = MonotonicClock::now() + std::chrono::seconds(2);
  while (server->busy() && MonotonicClock::now() < limit && !signals.wait(kRest)) server->serve();
}

Status ServedDevice::State::render_and_send(std::size_t i) {
  ServingExecutor executor([this] { serve(); });
  const auto frame = way->render(i, executor);
  if (!frame) return frame.error();
  std::vector<Time> row_time;
  const Duration period = simulator.description().sensor.row_period;
  for (int row = 0; row < frame->raw.rows(); ++row) row_time.push_back(frame->time + epoch + row * period);
  std::vector<StampedPose> poses = poses_around(way->odometry(), frame->time, simulator.last_row_time(i));
  for (StampedPose& pose : poses) pose.time += epoch;
  auto message = std::make_shared<std::vector<std::uint8_t>>();
  const auto encoded = encoder.encode({i, row_time, poses, PoseVariance{}, frame->raw, frame->reflectance}, *message);
  if (!encoded) return encoded;
  ++rendered;
  drivers::ServedFrame served{std::move(message), has_images ? image_of(frame->raw) : nullptr, false};
  server->send(faults ? faults->spoil(std::move(served), i) : std::move(served));
  return {};
}

Status ServedDevice::run() {
  State& s = *state_;
  spdlog::info("serving {} at {}", s.sensor, s.server->address());
  if (s.drive_socket) spdlog::info("driven at {}:{}", s.drive_host, s.drive_socket->local_port());
  const bool driven = s.robot.has_value();
  if (!driven && !s.serve_until([&] { return s.server->readers() > 0; })) return {};
  s.begin();
  const auto frames =
      std::min(s.way->frame_count().value_or(SIZE_MAX), static_cast<std::size_t>(s.options.frames.value_or(SIZE_MAX)));
  Progress progress("driving", frames == SIZE_MAX ? 0 : frames);
  for (std::size_t i = 0; i < frames; ++i) {
    if (!s.serve_until([&] { return s.way->can_render(i); })) break;
    progress.show(i);
    if (i + 1 < frames && s.way->can_render(i + 1)) {
      ++s.late;  // a newer one is due already
      continue;
    }
    if (s.server->readers() == 0) {
      ++s.unread;
      continue;
    }
    if (const auto done = s.render_and_send(i); !done) return done;
  }
  s.drain();
  progress.clear();
  if (s.track.is_open() && !s.track.flush())
    return Error{ErrorKind::io, *s.options.track + ": expected to take the track, found a failed write"};
  return s.error ? Status(*s.error) : Status{};
}

ServedDevice::ServedDevice(std::unique_ptr<State> state) : state_(std::move(state)) {}
ServedDevice::~ServedDevice() = default;

}  // namespace scree::node
