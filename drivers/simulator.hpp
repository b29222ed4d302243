#pragma once
// The simulated scanner: terrain, sensor, way and physics in; range frames as the real device would record them out.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "drivers/odometry.hpp"
#include "drivers/recording.hpp"
#include "drivers/simulator_physics.hpp"
#include "drivers/simulator_sensors.hpp"
#include "drivers/source.hpp"
#include "drivers/terrain_load.hpp"
#include "drivers/trajectory.hpp"

namespace scree::drivers {

struct SimulatorConfig {
  std::string terrain;                    ///< see load_terrain
  std::string sensor = "perceptron-usf";  ///< perceptron-usf | perceptron-cmu | lidar64 | depth | depth-small
  std::string trajectory;                 ///< see make_trajectory
  bool noise = true;                      ///< false: `--noise off`, exact to quantisation
  std::uint64_t seed = 1;
  Duration frame_period{0};              ///< 0 = the sensor's own
  std::optional<Pose> T_body_sensor;     ///< nothing = the sensor's usual mounting
  std::optional<SensorPhysics> physics;  ///< nothing = the sensor's nominal physics
  BodyPlacement placement = BodyPlacement::footprint;
  OdometryErrors odometry;  ///< of the poses that frames and recordings bring; rays leave the true ones
  SurveyGridding gridding;
};

/// One frame as recorded, with the truth beside it. All grids rows × columns, row 0 the top.
struct SimulatedFrame {
  std::uint64_t sequence = 0;
  Time time;                        ///< of row 0, from the trajectory's zero
  Grid<std::uint16_t> raw;          ///< counts; 0 = met nothing
  Grid<float> true_range_m;         ///< along the pixel's central ray, NaN = no surface; not wrapped, no noise
  Grid<std::uint16_t> reflectance;  ///< 0 … 4095 as the sensor takes it to be (without noise: of the ground)
};

class Simulator {
 public:
  /// Loads or makes the terrain, puts the way onto it. Errors: usage (names, grammars, a way off the terrain),
  /// no_input, bad_data.
  static Result<Simulator> make(const SimulatorConfig& config);
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;
  ~Simulator();

  /// For recording.yaml: origin sim, the complete projection, trusted_rows = all rows, invalid_raw 0, and a range noise
  /// that is the honest one of the physics (its rms over the sensor's view of level ground).
  const RecordingDescription& description() const;
  const SimulatorConfig& config() const;
  std::size_t frame_count() const;
  /// Frame i; the same whatever was rendered before and by however many threads. Errors: usage (i out of range).
  Result<SimulatedFrame> render(std::size_t i, Executor& executor) const;
  /// The same from where `track` says the body is, for a robot that is driven: any i. Errors: usage (the track does not
  /// cover the frame's rows).
  Result<SimulatedFrame> render_along(const PoseTrack& track, std::size_t i, Executor& executor) const;
  /// Time of row 0 of frame i.
  Time frame_time(std::size_t i) const;
  /// Time of its last row.
  Time last_row_time(std::size_t i) const;
  const Terrain& terrain() const;
  /// Where the scanner was.
  const PoseTrack& poses() const;
  /// Where odometry says that it was: poses() unless the configuration has errors.
  const PoseTrack& odometry() const;
  /// The frame as a source would deliver it: metres, row times and odometry's poses, all moved by `epoch`.
  std::shared_ptr<const RangeFrame> range_frame(const SimulatedFrame& frame, Duration epoch) const;

 private:
  struct State;
  explicit Simulator(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Called after each frame with the number done so far and the number in all.
using FrameProgress = std::function<void(std::size_t done, std::size_t count)>;

/// Renders every frame into `directory` in the recording format, with truth/NNNNNN.range.npy, truth/terrain.tif and
/// truth/poses.csv (the true ones; poses.csv has odometry's).
/// `recording_yaml` is the text for recording.yaml, made from description(). Errors: cannot_create, io.
/// Without GDAL in the build truth/terrain.npy takes the raster's place.
Status write_recording(const Simulator& simulator, const std::filesystem::path& directory,
                       const std::string& recording_yaml, Executor& executor, const FrameProgress& progress = {});

/// The simulated scanner as a live device that renders in this process. `real_time`: frames come when their last row is
/// due on the wall clock, stamped with it; one that rendering was too slow for is Kind::skipped. Otherwise as fast as
/// it renders, stamped with the trajectory's time. Ends with the trajectory.
Result<std::unique_ptr<Source>> simulated_source(const SimulatorConfig& config, bool real_time);

}  // namespace scree::drivers
