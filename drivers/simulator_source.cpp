// The simulated scanner as a live device.

#include <algorithm>
#include <fmt/format.h>
#include <thread>

#include "drivers/simulator.hpp"

namespace scree::drivers {
namespace {

class SimulatedSource final : public Source {
 public:
  SimulatedSource(Simulator simulator, std::string name, bool real_time)
      : simulator_(std::move(simulator)), name_(std::move(name)), real_time_(real_time) {}

  Result<SourceEvent> next(std::chrono::milliseconds timeout) override {
    if (next_ >= simulator_.frame_count()) return SourceEvent{SourceEvent::Kind::end_of_stream, nullptr, {}};
    if (real_time_) {
      start();
      if (!wait_until_due(timeout)) return SourceEvent{SourceEvent::Kind::timeout, nullptr, {}};
      if (next_ + 1 < simulator_.frame_count() && is_due(next_ + 1)) return skip();
    }
    const auto frame = simulator_.render(next_++, executor_);
    if (!frame) return frame.error();
    return SourceEvent{SourceEvent::Kind::frame, simulator_.range_frame(*frame, epoch_), {}};
  }

  Origin origin() const override { return Origin::sim; }
  std::string name() const override { return name_; }
  std::optional<std::size_t> frame_count() const override { return simulator_.frame_count(); }

 private:
  /// The drive begins with the first question for a frame.
  void start() {
    if (started_) return;
    started_ = true;
    begin_ = MonotonicClock::now();
    epoch_ = std::chrono::round<Duration>(std::chrono::system_clock::now().time_since_epoch()) -
             simulator_.frame_time(0).time_since_epoch();
  }

  /// A frame can be had when its last row is taken.
  MonotonicTime due(std::size_t i) const {
    const SensorConfig& sensor = simulator_.description().sensor;
    const Duration scan = sensor.row_period * std::max(sensor.projection.rows - 1, 0);
    return begin_ + std::chrono::duration_cast<MonotonicClock::duration>(simulator_.frame_time(i) -
                                                                         simulator_.frame_time(0) + scan);
  }
  bool is_due(std::size_t i) const { return MonotonicClock::now() >= due(i); }

  bool wait_until_due(std::chrono::milliseconds timeout) const {
    const auto now = MonotonicClock::now();
    std::this_thread::sleep_until(std::min(due(next_), now + timeout));
    return is_due(next_);
  }

  /// A newer frame is there already: this one is not worth its rendering.
  SourceEvent skip() {
    const std::size_t lost = next_++;
    return {
        SourceEvent::Kind::skipped, nullptr,
        fmt::format("{}: frame {}: expected to be rendered before the next one is due, found it late", name_, lost)};
  }

  Simulator simulator_;
  std::string name_;
  bool real_time_;
  bool started_ = false;
  MonotonicTime begin_;
  Duration epoch_{0};
  std::size_t next_ = 0;
  SerialExecutor executor_;
};

}  // namespace

Result<std::unique_ptr<Source>> simulated_source(const SimulatorConfig& config, bool real_time) {
  auto simulator = Simulator::make(config);
  if (!simulator) return simulator.error();
  std::string name = fmt::format("simulated {} over {}", config.sensor, config.terrain);
  return std::unique_ptr<Source>(std::make_unique<SimulatedSource>(*std::move(simulator), std::move(name), real_time));
}

}  // namespace scree::drivers
