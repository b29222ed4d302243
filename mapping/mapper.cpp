#include "mapping/mapper.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

#include "core/rolling_grid.hpp"
#include "mapping/alignment.hpp"
#include "mapping/cell_points.hpp"
#include "mapping/frame_returns.hpp"
#include "mapping/fusion.hpp"
#include "mapping/layers.hpp"
#include "mapping/snapshot_pool.hpp"
#include "mapping/visibility.hpp"

namespace scree::mapping {

namespace {

// The window follows the robot only when it is this far off centre: a robot that stands on a cell border must not make
// rows leave and enter.
constexpr std::int32_t kSlackCells = 2;
// Keeps lattice arithmetic far from overflow.
constexpr double kLatticeLimit = 1e9;

GroundConfig ground_config(const MapConfig& config) {
  return {static_cast<float>(config.cell_m), static_cast<float>(config.vehicle.height_m),
          static_cast<float>(config.outlier_sigmas)};
}

VisibilityConfig visibility_config(const MapConfig& config) {
  VisibilityConfig out;
  out.cell_m = config.cell_m;
  out.size_cells = config.size_cells;
  out.max_descent = static_cast<float>(std::tan(std::min(config.vehicle.max_pitch_rad, 1.5)));
  out.margin_m = static_cast<float>(config.drop_margin_m);
  return out;
}

Status on_lattice(const Eigen::Vector3d& body_map_m, std::uint64_t sequence, double cell_m) {
  if (body_map_m.allFinite() && body_map_m.cwiseAbs().maxCoeff() < kLatticeLimit * cell_m) return {};
  return Error{ErrorKind::bad_data,
               fmt::format("frame {}: body position: expected coordinates within ±{:g} m of the map's origin, found "
                           "({:g}, {:g}, {:g})",
                           sequence, kLatticeLimit * cell_m, body_map_m.x(), body_map_m.y(), body_map_m.z())};
}

}  // namespace

struct Mapper::State {
  State(const MapConfig& map_config, Executor& map_executor)
      : config(map_config),
        executor(map_executor),
        map(map_config.size_cells, map_config.size_cells, MapCell{}),
        fusion(ground_config(map_config)),
        visibility(visibility_config(map_config)),
        layers(map_config),
        known_ground([this](double x_m, double y_m) { return measured_at(x_m, y_m); }) {}

  std::optional<GroundHeight> measured_at(double x_m, double y_m) const;
  void follow(const Eigen::Vector3d& body_map_m);
  PoseVariance pose_variance(const PoseVariance& told) const;
  std::uint32_t clock_ms(Time time);
  const PointFrame& gather(const PointFrame& frame);

  MapConfig config;
  Executor& executor;
  PointConverter converter;
  PointFrame points;
  RollingGrid<MapCell> map;
  CellPoints cell_points;
  FrameReturns frame_returns;
  Alignment alignment;
  Fusion fusion;
  Visibility visibility;
  Layers layers;
  GroundLookup known_ground;
  SnapshotPool pool;
  std::uint32_t revision = 0;
  std::optional<Time> begin;  ///< of the clock of MapCell::fused_ms
  std::shared_ptr<const MapSnapshot> latest;
};

std::optional<GroundHeight> Mapper::State::measured_at(double x_m, double y_m) const {
  const double limit_m = kLatticeLimit * config.cell_m;
  if (!(std::abs(x_m) < limit_m && std::abs(y_m) < limit_m)) return std::nullopt;
  const CellIndex index = lattice_cell(x_m, y_m, config.cell_m);
  if (!map.window().contains(index)) return std::nullopt;
  const MapCell& cell = map.at(index);
  if (!cell.measured()) return std::nullopt;
  const float variance_m2 = height_variance_m2(cell, static_cast<float>(config.cell_m));
  return GroundHeight{static_cast<double>(cell.height_m), std::sqrt(static_cast<double>(variance_m2))};
}

void Mapper::State::follow(const Eigen::Vector3d& body_map_m) {
  const CellIndex body = lattice_cell(body_map_m.x(), body_map_m.y(), config.cell_m);
  const CellIndex centred{body.x - config.size_cells / 2, body.y - config.size_cells / 2};
  if (revision == 0) return map.roll_to(centred);
  const CellIndex now = map.window().min;
  map.roll_to({std::clamp(now.x, centred.x - kSlackCells, centred.x + kSlackCells),
               std::clamp(now.y, centred.y - kSlackCells, centred.y + kSlackCells)});
}

/// Zero where the source tells none and none was configured.
PoseVariance Mapper::State::pose_variance(const PoseVariance& told) const {
  const auto otherwise = [](const Eigen::Vector3d& given, const Eigen::Vector3d& sigma) {
    return given.isZero(0.0) ? Eigen::Vector3d(sigma.cwiseAbs2()) : given;
  };
  const double xy_m = config.pose_sigma_xy_m;
  return {otherwise(told.position_m2, {xy_m, xy_m, config.pose_sigma_z_m}),
          otherwise(told.attitude_rad2, Eigen::Vector3d::Constant(config.pose_sigma_attitude_rad))};
}

/// The frame's returns by cell, where the frame lies on the map: at most one step beside where the last one did.
/// Returns the frame placed there.
const PointFrame& Mapper::State::gather(const PointFrame& frame) {
  const PoseVariance pose = pose_variance(frame.pose_variance);
  const PointFrame* placed = &frame;
  for (int pass = 0; pass < 2; ++pass) {
    if (config.align_frames) placed = &alignment.place(frame);
    cell_points.sort(*placed, map.window(), config.cell_m, executor);
    frame_returns.gather(*placed, pose, cell_points, map, ground_config(config), executor);
    if (!config.align_frames || !alignment.fit(frame, config.cell_m, map, frame_returns)) break;
  }
  return *placed;
}

std::uint32_t Mapper::State::clock_ms(Time time) {
  if (!begin) begin = time;
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(time - *begin).count());
}

Mapper::Mapper(const MapConfig& config, Executor& executor) : state_(std::make_unique<State>(config, executor)) {}
Mapper::~Mapper() = default;

Result<StepReport> Mapper::step(const RangeFrame& frame) {
  State& s = *state_;
  if (!frame.T_map_body.empty()) {
    if (const Status ok = on_lattice(frame.T_map_body.back().translation_m, frame.sequence, s.config.cell_m); !ok)
      return ok.error();
  }
  StageClock clock;
  if (const Status ok = s.converter.convert(frame, s.known_ground, s.executor, s.points); !ok) return ok.error();
  clock.lap(Stage::convert);
  return integrate(s.points, clock);
}

Result<StepReport> Mapper::integrate(const PointFrame& points) {
  StageClock clock;
  return integrate(points, clock);
}

Result<StepReport> Mapper::integrate(const PointFrame& points, StageClock& clock) {
  State& s = *state_;
  const Eigen::Vector3d& body_map_m = points.T_map_body.translation_m;
  if (const Status ok = on_lattice(body_map_m, points.sequence, s.config.cell_m); !ok) return ok.error();

  s.follow(body_map_m);
  const PointFrame& placed = s.gather(points);
  AlignmentReport aligned;
  if (s.config.align_frames) aligned = s.alignment.align(placed, s.config.cell_m, s.executor, s.map, s.frame_returns);
  const std::uint32_t now_ms = s.clock_ms(points.time);
  clock.lap(Stage::fuse);
  // before the fusion, for which what hangs above passing rays is no ground
  if (!aligned.refused) s.visibility.update(placed, s.cell_points, aligned.off, s.executor, s.map);
  clock.lap(Stage::look);
  const FusionCounts counts = aligned.refused
                                  ? Fusion::refuse(s.frame_returns)
                                  : s.fusion.fuse(s.frame_returns, now_ms, GateLaw(s.latest.get()), s.executor, s.map);
  if (s.config.align_frames) s.alignment.carry(s.config.cell_m, s.map);
  clock.lap(Stage::fuse);

  s.latest.reset();  // with no reader left its buffers are the next snapshot's
  const std::shared_ptr<MapSnapshot> next = s.pool.acquire();
  next->revision = ++s.revision;
  next->cell_m = s.config.cell_m;
  next->window = s.map.window();
  next->data_time = points.time;
  next->received = points.received;
  next->T_map_body = points.T_map_body;
  s.layers.compute(s.map, now_ms, s.executor, clock, *next);
  s.latest = next;

  StepReport report;
  report.counts = points.counts;
  report.points_fused = counts.fused;
  report.points_outside = s.cell_points.outside();
  report.points_outlier = counts.outlier;
  report.points_other_surface = counts.other_surface;
  report.stages = clock.times();
  report.points_unsupported = counts.unsupported;
  report.alignment = aligned;
  return report;
}

std::shared_ptr<const MapSnapshot> Mapper::snapshot() {
  return state_->latest;
}

}  // namespace scree::mapping
