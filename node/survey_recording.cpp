// A recording as a survey: the points of all its frames in the map frame, through the filters of the live node.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "config/settings.hpp"
#include "core/executor.hpp"
#include "node/node_source.hpp"
#include "node/progress.hpp"
#include "node/survey_readers.hpp"

namespace scree::node {
namespace {

constexpr std::size_t kMostPoints = std::size_t{1} << 27;  // 1.6 GB of coordinates

/// Sums over points, for the rms noise.
struct NoiseSums {
  double vertical_m2 = 0.0, horizontal_m2 = 0.0;

  void add(const PointFrame& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto variance = static_cast<double>(points.range_variance_m2[i]);
      const auto z = static_cast<double>(points.direction_z[i]);
      vertical_m2 += z * z * variance;
      horizontal_m2 += 0.5 * (1.0 - z * z) * variance;
    }
  }
};

void add_points(const PointFrame& points, SurveyInput& survey) {
  if (survey.all.size() == 0) survey.origin_m = points.anchor_map_m;
  const Eigen::Vector3f offset = (points.anchor_map_m - survey.origin_m).cast<float>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = Eigen::Vector3f(points.x_m[i], points.y_m[i], points.z_m[i]) + offset;
    if (p.allFinite()) survey.all.push_back(p.x(), p.y(), p.z());
  }
}

/// Nothing is known of the ground beforehand: where a range is ambiguous and no ground near the robot tells its
/// interval, the pixel is left out and counted, as in the first frame of the node.
Status read_frames(drivers::Source& source, std::size_t most_frames, SurveyInput& survey, NoiseSums& noise) {
  SerialExecutor executor;
  PointConverter converter;
  PointFrame points;
  SurveyFrames& frames = *survey.frames;
  const std::size_t total = source.frame_count().value_or(0);
  Progress progress("frames", most_frames > 0 ? std::min(total, most_frames) : total);
  while (most_frames == 0 || frames.frames < most_frames) {
    const auto event = source.next(std::chrono::milliseconds(1000));
    if (!event) return event.error();
    using Kind = drivers::SourceEvent::Kind;
    if (event->kind == Kind::end_of_stream) break;
    if (event->kind == Kind::skipped) {
      ++frames.skipped_frames;
      progress.clear();
      spdlog::warn("skipped: {}", event->message);
    }
    if (event->kind != Kind::frame) continue;
    if (auto status = converter.convert(*event->frame, {}, executor, points); !status) return status;
    frames.counts += points.counts;
    noise.add(points);
    add_points(points, survey);
    progress.show(++frames.frames);
    if (survey.all.size() > kMostPoints)
      return Error{ErrorKind::bad_data, fmt::format("{}: expected at most {} points, found more in {} frames; take "
                                                    "fewer: --frames",
                                                    source.name(), kMostPoints, frames.frames)};
  }
  return {};
}

}  // namespace

Result<SurveyInput> read_recording_survey(const std::filesystem::path& file, const SurveyReading& reading) {
  const auto source = open_input(file.string(), reading.format, {}, config::Settings{});
  if (!source) return source.error();
  SurveyInput survey;
  survey.frames.emplace();
  NoiseSums noise;
  if (auto status = read_frames(**source, reading.frames, survey, noise); !status) return status.error();
  survey.skipped = survey.frames->counts.pixels - survey.all.size();
  if (survey.all.size() > 0) {
    const auto count = static_cast<double>(survey.all.size());
    survey.frames->noise_sigma_m = std::sqrt(noise.vertical_m2 / count);
    survey.frames->noise_xy_sigma_m = std::sqrt(noise.horizontal_m2 / count);
  }
  choose_points(survey, reading);
  return survey;
}

}  // namespace scree::node
