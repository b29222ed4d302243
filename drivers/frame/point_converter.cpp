// The order of the stages of PointConverter, its checks and its counting.

#include <array>
#include <cmath>
#include <fmt/format.h>

#include "drivers/frame/cartesian.hpp"
#include "drivers/frame/image_edges.hpp"
#include "drivers/frame/neighbour_filter.hpp"
#include "drivers/frame/phase_resolution.hpp"
#include "drivers/frame/pixel_state.hpp"
#include "drivers/frame/point_frame.hpp"
#include "drivers/frame/ray_tables.hpp"
#include "drivers/frame/row_poses.hpp"
#include "drivers/frame/surfaces.hpp"

namespace scree {

struct PointConverter::Workspace {
  RayTables tables;
  RowPoses poses;
  Grid<PixelState> state;
  Grid<float> range_m;  ///< of the frame at first, resolved later
  Grid<std::int8_t> wraps;
  ImageEdges edges;
  Surfaces surfaces;
  PhaseResolver resolver;

  void classify(const RangeFrame& frame, Executor& executor);
  void drop_small_surfaces(Executor& executor);
  bool resolve_phase(const GroundLookup& ground, Executor& executor);
  PixelCounts count(bool assumed) const;
};

namespace {

Error contradiction(const RangeFrame& frame, std::string_view what, const std::string& expected,
                    const std::string& found) {
  return {ErrorKind::bad_data,
          fmt::format("frame {}: {}: expected {}, found {}", frame.sequence, what, expected, found)};
}

Status check(const RangeFrame& frame) {
  if (!frame.projection || !frame.sensor)
    return contradiction(frame, "projection and sensor", "both", frame.projection ? "no sensor" : "no projection");
  const int rows = frame.projection->rows;
  const int columns = frame.projection->columns;
  if (rows < 1 || frame.range_m.rows() != rows || frame.range_m.columns() != columns)
    return contradiction(frame, "ranges", fmt::format("{} x {}", rows, columns),
                         fmt::format("{} x {}", frame.range_m.rows(), frame.range_m.columns()));
  const auto expected = static_cast<std::size_t>(rows);
  if (frame.row_time.size() != expected || frame.T_map_body.size() != expected)
    return contradiction(frame, "rows", fmt::format("{} times and poses", rows),
                         fmt::format("{} times and {} poses", frame.row_time.size(), frame.T_map_body.size()));
  for (std::size_t r = 0; r < expected; ++r)
    if (const Pose& pose = frame.T_map_body[r]; !pose.translation_m.allFinite() || !pose.rotation.coeffs().allFinite())
      return contradiction(frame, fmt::format("pose of row {}", r), "finite numbers", "NaN or infinity");
  return {};
}

struct Limits {
  float min_m, max_m;
  bool hold(float range_m) const { return range_m > 0.0F && range_m >= min_m && range_m <= max_m; }
};

Limits limits_of(const FilterConfig& filter) {
  return {static_cast<float>(filter.range_min_m), static_cast<float>(filter.range_max_m)};
}

/// An ambiguous return is the robot itself when any of its readings is.
bool hits_self(const RayTables& tables, std::size_t i, float range_m) {
  const float near = tables.self_near_m[i];
  const float far = tables.self_far_m[i];
  if (near > far) return false;
  const float ambiguity = static_cast<float>(tables.projection->ambiguity_m);
  if (ambiguity == 0.0F) return range_m >= near && range_m <= far;
  for (int k = PhaseEvidence::kFirstCandidate; k <= tables.sensor->filter.max_wraps; ++k) {
    const float candidate_m = range_m + static_cast<float>(k) * ambiguity;
    if (candidate_m >= near && candidate_m <= far) return true;
  }
  return false;
}

}  // namespace

void PointConverter::Workspace::classify(const RangeFrame& frame, Executor& executor) {
  const Projection& projection = *frame.projection;
  const Limits limits = limits_of(frame.sensor->filter);
  const bool masked = frame.sensor->filter.self_mask.has_value();
  const bool ambiguous = projection.ambiguity_m > 0.0;
  range_m = frame.range_m;
  state.assign(projection.rows, projection.columns, PixelState::kept);
  for_rows(executor, projection.rows, [&](int begin, int end) {
    const auto columns = static_cast<std::size_t>(projection.columns);
    for (std::size_t i = static_cast<std::size_t>(begin) * columns; i < static_cast<std::size_t>(end) * columns; ++i) {
      const float range = range_m[i];
      if (i / columns >= static_cast<std::size_t>(projection.config.trusted_rows))
        state[i] = PixelState::untrusted_row;
      else if (!std::isfinite(range))
        state[i] = PixelState::no_return;
      else if (!ambiguous && !limits.hold(range))
        state[i] = PixelState::out_of_limits;
      else if (masked && hits_self(tables, i, range))
        state[i] = PixelState::self;
      if (state[i] != PixelState::kept) range_m[i] = std::nanf("");
    }
  });
}

void PointConverter::Workspace::drop_small_surfaces(Executor& executor) {
  const int min_pixels = tables.sensor->filter.speckle_min_pixels;
  if (min_pixels <= 1) return;
  const auto columns = static_cast<std::size_t>(state.columns());
  for_rows(executor, state.rows(), [&](int begin, int end) {
    for (std::size_t i = static_cast<std::size_t>(begin) * columns; i < static_cast<std::size_t>(end) * columns; ++i)
      if (state[i] == PixelState::kept && surfaces.size(surfaces.root(i)) < min_pixels) state[i] = PixelState::speckle;
  });
}

bool PointConverter::Workspace::resolve_phase(const GroundLookup& ground, Executor& executor) {
  const bool assumed = resolver.resolve({tables, poses, ground, edges}, surfaces, state, range_m, wraps);
  const Limits limits = limits_of(tables.sensor->filter);
  const auto columns = static_cast<std::size_t>(state.columns());
  for_rows(executor, state.rows(), [&](int begin, int end) {
    for (std::size_t i = static_cast<std::size_t>(begin) * columns; i < static_cast<std::size_t>(end) * columns; ++i)
      if (state[i] == PixelState::kept && !limits.hold(range_m[i])) state[i] = PixelState::out_of_limits;
  });
  return assumed;
}

PixelCounts PointConverter::Workspace::count(bool assumed) const {
  std::array<std::uint64_t, kPixelStates> in_state{};
  for (const PixelState pixel : state) ++in_state[static_cast<std::size_t>(pixel)];
  const auto of = [&](PixelState pixel) { return in_state[static_cast<std::size_t>(pixel)]; };
  PixelCounts counts;
  counts.pixels = state.size();
  counts.points = of(PixelState::kept);
  counts.no_return = of(PixelState::no_return);
  counts.untrusted_row = of(PixelState::untrusted_row);
  counts.out_of_limits = of(PixelState::out_of_limits);
  counts.self = of(PixelState::self);
  counts.speckle = of(PixelState::speckle);
  counts.mixed = of(PixelState::mixed);
  counts.ambiguous = of(PixelState::ambiguous);
  if (assumed) counts.assumed_first_interval = counts.points;
  if (tables.projection->is_image() && tables.projection->ambiguity_m > 0.0)
    for (std::size_t i = 0; i < state.size(); ++i)
      counts.wrapped += state[i] == PixelState::kept && wraps[i] != 0 ? 1U : 0U;
  return counts;
}

PointConverter::PointConverter() : workspace_(std::make_unique<Workspace>()) {}
PointConverter::PointConverter(PointConverter&&) noexcept = default;
PointConverter& PointConverter::operator=(PointConverter&&) noexcept = default;
PointConverter::~PointConverter() = default;

Status PointConverter::convert(const RangeFrame& frame, const GroundLookup& ground, Executor& executor,
                               PointFrame& out) {
  if (auto status = check(frame); !status) return status;
  Workspace& w = *workspace_;
  const FilterConfig& filter = frame.sensor->filter;
  const bool image = frame.projection->is_image();
  const bool ambiguous = image && frame.projection->ambiguity_m > 0.0;
  const bool speckle = image && filter.speckle_min_pixels > 0;
  w.tables.prepare(frame.projection, frame.sensor, executor);
  w.poses.compute(frame);
  w.classify(frame, executor);

  if (speckle || ambiguous || (image && filter.mixed_pixels)) {
    w.edges.compute(w.range_m, w.tables, executor);
    reject_by_neighbours(w.range_m, w.edges, w.tables, executor, w.state);
  }
  if (speckle || ambiguous) {
    w.surfaces.label(w.state, w.edges, ambiguous ? Surfaces::Joining::cores : Surfaces::Joining::edges);
    w.drop_small_surfaces(executor);
  }
  const bool assumed = ambiguous && w.resolve_phase(ground, executor);

  out.sequence = frame.sequence;
  out.time = frame.row_time.back();
  out.received = frame.received;
  out.T_map_body = frame.T_map_body.back();
  out.pose_variance = frame.pose_variance;
  out.angle_sigma_rad = static_cast<float>(frame.sensor->noise.angle_rad);
  write_points(w.tables, w.poses, w.state, w.range_m, executor, out);
  out.counts = w.count(assumed);
  return {};
}

}  // namespace scree
