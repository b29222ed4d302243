// Fused heights and roughness under pose errors: the tables of docs/mapping.md.
//
//   fusion_study [errors|drift|frames]… [SENSOR]… [--seeds=N] [--unaligned]    (all when none is named)
//
// One rendering per drive: rays leave the true poses, so the same ranges serve every odometry. Truth is moved to the
// place and heading that odometry has in the end: a map that follows its poses is compared where the robot is now.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "drivers/simulator.hpp"
#include "mapping/mapper.hpp"

namespace scree {
namespace {

using drivers::OdometryErrors;
using drivers::Simulator;
using drivers::SimulatorConfig;

struct Drive {
  const char* sensor;
  double dimension, amplitude_m, length_m, speed_mps;
  double period_s;  ///< 0 = the sensor's own
};

constexpr Drive kDrives[] = {
    {"perceptron-cmu", 2.3, 0.08, 8, 1.0, 0}, {"perceptron-cmu", 2.6, 0.04, 8, 1.0, 0},
    {"lidar64", 2.3, 0.08, 8, 1.0, 0.4},      {"lidar64", 2.6, 0.04, 8, 1.0, 0.4},
    {"depth", 2.3, 0.08, 4, 1.0, 0.3},        {"depth", 2.6, 0.04, 4, 1.0, 0.3},
};

template <class T>
T must(Result<T> result) {
  if (result) return *std::move(result);
  std::fprintf(stderr, "fusion_study: %s\n", result.error().message.c_str());
  std::exit(1);
}

SimulatorConfig config_of(const Drive& drive, std::uint64_t seed) {
  SimulatorConfig config;
  char text[128];
  std::snprintf(text, sizeof text, "fbm:%g,%g,%d,36,0.05", drive.dimension, drive.amplitude_m, static_cast<int>(seed));
  config.terrain = text;
  config.sensor = drive.sensor;
  std::snprintf(text, sizeof text, "line:%g,0,0,%g,%g", -0.5 * drive.length_m - 2.0, drive.length_m, drive.speed_mps);
  config.trajectory = text;
  config.seed = seed;
  config.frame_period = from_seconds(drive.period_s);
  return config;
}

/// A drive's frames with true poses.
struct Rendered {
  Simulator simulator;
  std::vector<std::shared_ptr<const RangeFrame>> frames;
};

Rendered render(const Drive& drive, std::uint64_t seed) {
  Rendered out{must(Simulator::make(config_of(drive, seed))), {}};
  SerialExecutor serial;
  for (std::size_t i = 0; i < out.simulator.frame_count(); ++i)
    out.frames.push_back(out.simulator.range_frame(must(out.simulator.render(i, serial)), Duration{0}));
  return out;
}

/// The same ranges with odometry's poses.
RangeFrame posed(const RangeFrame& frame, const PoseTrack& track) {
  RangeFrame out = frame;
  for (std::size_t row = 0; row < out.row_time.size(); ++row)
    if (const auto pose = track.at(out.row_time[row])) out.T_map_body[row] = *pose;
  return out;
}

struct Run {
  std::shared_ptr<const mapping::MapSnapshot> map;
  Pose T_odometry_truth;
  mapping::StepReport last;
};

Run run(const Rendered& drive, const PoseTrack& track, const mapping::MapConfig& config, std::size_t first,
        std::size_t end) {
  SerialExecutor serial;
  mapping::Mapper mapper(config, serial);
  Run out;
  for (std::size_t i = first; i < end; ++i) out.last = must(mapper.step(posed(*drive.frames[i], track)));
  out.map = mapper.snapshot();
  // Place and heading as odometry has them, up as it is: nobody can tell a newest pose's tilt from the map's.
  const Pose &truth = drive.frames[end - 1]->T_map_body.back(), &odometry = out.map->T_map_body;
  const Eigen::Vector3d turned = odometry.rotation * truth.rotation.inverse() * Eigen::Vector3d::UnitX();
  out.T_odometry_truth.rotation = Eigen::AngleAxisd(std::atan2(turned.y(), turned.x()), Eigen::Vector3d::UnitZ());
  out.T_odometry_truth.translation_m = odometry.translation_m - out.T_odometry_truth.rotation * truth.translation_m;
  return out;
}

/// Mean of the terrain inside a cell, in the frame of odometry.
double true_height_m(const Run& run, const drivers::Terrain& terrain, int row, int column) {
  const mapping::MapSnapshot& map = *run.map;
  const Pose T_truth_odometry = run.T_odometry_truth.inverse();
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      Eigen::Vector3d p((map.window.min.x + column + 0.1 + 0.2 * i) * map.cell_m,
                        (map.window.min.y + row + 0.1 + 0.2 * j) * map.cell_m,
                        static_cast<double>(map.elevation_m(row, column)));
      const Eigen::Vector3d q = T_truth_odometry * p;
      const double z = terrain.height_m(q.x(), q.y());
      if (std::isnan(z)) continue;
      sum += p.z() + z - q.z();  // tilts are small: a metre up is a metre up in both
      ++count;
    }
  return count > 0 ? sum / count : std::nan("");
}

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Errors {
  std::size_t cells = 0;
  double shape_m = 0;  ///< rms error about the plane that fits the errors best
  double rms_m = 0, median_m = 0, sigma_m = 0, normalised = 0, median_normalised = 0, within = 0, lethal = 0;
};

Errors errors_of(const Run& run, const drivers::Terrain& terrain) {
  std::vector<double> error, absolute, sigma;
  double squares = 0, normalised = 0, within = 0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  Errors out;
  const mapping::MapSnapshot& map = *run.map;
  for (int row = 0; row < map.window.rows; ++row)
    for (int column = 0; column < map.window.columns; ++column) {
      if (map.state(row, column) != CellState::measured) continue;
      const double truth = true_height_m(run, terrain, row, column);
      if (std::isnan(truth)) continue;
      const double e = static_cast<double>(map.elevation_m(row, column)) - truth;
      const double s = static_cast<double>(map.elevation_sigma_m(row, column));
      error.push_back(e);
      absolute.push_back(std::abs(e / s));
      sigma.push_back(s);
      squares += e * e;
      const Eigen::Vector3d plane(1.0, row * map.cell_m, column * map.cell_m);
      normal += plane * plane.transpose();
      right += plane * e;
      normalised += e * e / (s * s);
      within += std::abs(e) <= 1.6449 * s ? 1 : 0;
      out.lethal += map.cost(row, column) == mapping::kCostLethal ? 1 : 0;
    }
  const auto n = static_cast<double>(error.size());
  out.cells = error.size();
  out.rms_m = std::sqrt(squares / n);
  out.shape_m = std::sqrt(std::max(0.0, squares - right.dot(normal.ldlt().solve(right))) / n);
  out.median_m = median(error);
  out.sigma_m = median(sigma);
  out.normalised = std::sqrt(normalised / n);
  out.median_normalised = median(absolute);
  out.within = within / n;
  out.lethal /= n;
  return out;
}

constexpr double kDegree = 0.017453292519943295;
constexpr OdometryErrors kOdometry[] = {{0.0, 0.0}, {0.01, kDegree}, {0.03, kDegree}, {0.03, kDegree}};
constexpr const char* kOdometryNames[] = {"none", "1 %, 1°", "3 %, 1°", "3 %, 1°, sigma told"};

/// D against that of the same ground in another run: median of the difference, median of its absolute value.
struct Bias {
  double median = 0, absolute = 0;
  std::size_t cells = 0;
};

Bias bias_of(const Run& run, const Run& reference) {
  std::vector<double> difference, absolute;
  const mapping::MapSnapshot &map = *run.map, &other = *reference.map;
  for (int row = 0; row < map.window.rows; ++row)
    for (int column = 0; column < map.window.columns; ++column) {
      if (map.state(row, column) != CellState::measured || !std::isfinite(map.dimension(row, column))) continue;
      const Eigen::Vector3d p((map.window.min.x + column + 0.5) * map.cell_m,
                              (map.window.min.y + row + 0.5) * map.cell_m,
                              static_cast<double>(map.elevation_m(row, column)));
      const Eigen::Vector3d q = reference.T_odometry_truth * (run.T_odometry_truth.inverse() * p);
      const CellIndex cell = lattice_cell(q.x(), q.y(), other.cell_m);
      if (!other.window.contains(cell)) continue;
      const int r = cell.y - other.window.min.y, c = cell.x - other.window.min.x;
      if (other.state(r, c) != CellState::measured || !std::isfinite(other.dimension(r, c))) continue;
      difference.push_back(static_cast<double>(map.dimension(row, column) - other.dimension(r, c)));
      absolute.push_back(std::abs(difference.back()));
    }
  return {median(difference), median(absolute), difference.size()};
}

void print_row(const Drive& drive, const char* odometry, const Errors& e, const Bias& d, double dimension) {
  std::printf(
      "| %s, D %.1f | %s | %zu | %.1f | %.1f | %.1f | %.1f | %.2f | %.2f | %.3f | %.3f | %+.3f | %.3f | %.4f |\n",
      drive.sensor, drive.dimension, odometry, e.cells, 1e3 * e.rms_m, 1e3 * e.shape_m, 1e3 * e.median_m,
      1e3 * e.sigma_m, e.normalised, e.median_normalised, e.within, dimension, d.median, d.absolute, e.lethal);
  std::fflush(stdout);
}

double median_dimension(const Run& run) {
  std::vector<double> values;
  for (std::size_t i = 0; i < run.map->dimension.size(); ++i)
    if (run.map->state[i] == CellState::measured && std::isfinite(run.map->dimension[i]))
      values.push_back(static_cast<double>(run.map->dimension[i]));
  return median(values);
}

bool aligned = true;  ///< --unaligned: the maps of frames that are taken where their poses say

mapping::MapConfig map_config() {
  mapping::MapConfig config;
  config.align_frames = aligned;
  return config;
}

/// Errors without drift by distance from the robot at the end and by returns.
void errors(const std::vector<Drive>& drives) {
  std::printf(
      "| drive | bin | cells | rms error mm | mean mm | rms sigma mm | rms(e/σ) |\n|---|---|---|---|---|---|---|\n");
  for (const Drive& drive : drives) {
    const Rendered rendered = render(drive, 1);
    const Run at = run(rendered, rendered.simulator.poses(), map_config(), 0, rendered.frames.size());
    const mapping::MapSnapshot& map = *at.map;
    struct Bin {
      double n = 0, e = 0, e2 = 0, s2 = 0, q = 0;
    };
    std::map<std::string, Bin> bins;
    for (int row = 0; row < map.window.rows; ++row)
      for (int column = 0; column < map.window.columns; ++column) {
        if (map.state(row, column) != CellState::measured) continue;
        const double truth = true_height_m(at, rendered.simulator.terrain(), row, column);
        if (std::isnan(truth)) continue;
        const double e = static_cast<double>(map.elevation_m(row, column)) - truth;
        const double s = static_cast<double>(map.elevation_sigma_m(row, column));
        const double x = (map.window.min.x + column + 0.5) * map.cell_m - map.T_map_body.translation_m.x();
        const double y = (map.window.min.y + row + 0.5) * map.cell_m - map.T_map_body.translation_m.y();
        const int hits = map.hits(row, column);
        char name[64];
        std::snprintf(name, sizeof name, "distance %d m", static_cast<int>(std::hypot(x, y)));
        char other[64];
        std::snprintf(other, sizeof other, "hits 2^%02d", static_cast<int>(std::log2(hits)));
        for (const char* key : {name, other}) {
          Bin& bin = bins[key];
          bin.n += 1, bin.e += e, bin.e2 += e * e, bin.s2 += s * s, bin.q += e * e / (s * s);
        }
      }
    for (const auto& [name, bin] : bins)
      std::printf("| %s, D %.1f | %s | %.0f | %.1f | %+.1f | %.1f | %.2f |\n", drive.sensor, drive.dimension,
                  name.c_str(), bin.n, 1e3 * std::sqrt(bin.e2 / bin.n), 1e3 * bin.e / bin.n,
                  1e3 * std::sqrt(bin.s2 / bin.n), std::sqrt(bin.q / bin.n));
  }
}

/// Whole drives, at three odometries.
void drift(const std::vector<Drive>& drives, std::uint64_t seeds) {
  std::printf(
      "| drive | odometry | cells | rms error mm | of shape mm | median mm | sigma mm | rms(e/σ) | median(|e|/σ) | "
      "within "
      "1.645 σ | D | ΔD median | median |ΔD| | lethal |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Drive& drive : drives)
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const Rendered rendered = render(drive, seed);
      Run exact;
      for (int k = 0; k < 4; ++k) {
        const PoseTrack track = odometry_track(rendered.simulator.poses(), kOdometry[k], seed);
        mapping::MapConfig config = map_config();
        if (k == 3) config.pose_sigma_attitude_rad = kDegree;
        const Run at = run(rendered, track, config, 0, rendered.frames.size());
        if (k == 0) exact = at;
        print_row(drive, kOdometryNames[k], errors_of(at, rendered.simulator.terrain()), bias_of(at, exact),
                  median_dimension(at));
      }
    }
}

/// D from single frames and from the fused map, each against the run without drift.
void frames(const std::vector<Drive>& drives, std::uint64_t seeds) {
  std::printf(
      "| drive | odometry | ΔD fused: median, median |·| | ΔD within frames: median, median |·| | cells with D "
      "fused | within a frame | D fused | D within frames |\n|---|---|---|---|---|---|---|---|\n");
  for (const Drive& drive : drives)
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const Rendered rendered = render(drive, seed);
      const std::size_t n = rendered.frames.size();
      const PoseTrack truth = rendered.simulator.poses();
      const Run exact = run(rendered, truth, map_config(), 0, n);
      const Run exact_frame = run(rendered, truth, map_config(), n - 1, n);
      for (int k = 1; k < 3; ++k) {
        const PoseTrack track = odometry_track(truth, kOdometry[k], seed);
        const Run fused = run(rendered, track, map_config(), 0, n);
        const Run single = run(rendered, track, map_config(), n - 1, n);
        const Bias a = bias_of(fused, exact), b = bias_of(single, exact_frame);
        std::printf("| %s, D %.1f | %s | %+.3f, %.3f | %+.3f, %.3f | %zu | %zu | %.3f | %.3f |\n", drive.sensor,
                    drive.dimension, kOdometryNames[k], a.median, a.absolute, b.median, b.absolute, a.cells, b.cells,
                    median_dimension(fused), median_dimension(single));
        std::fflush(stdout);
      }
    }
}

}  // namespace
}  // namespace scree

int main(int argc, char** argv) {
  using namespace scree;
  std::vector<Drive> drives;
  std::vector<std::string> sections;
  std::uint64_t seeds = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.rfind("--seeds=", 0) == 0)
      seeds = std::stoul(word.substr(8));
    else if (word == "--unaligned")
      aligned = false;
    else if (word == "errors" || word == "drift" || word == "frames")
      sections.push_back(word);
    else
      for (const Drive& drive : kDrives)
        if (word == drive.sensor) drives.push_back(drive);
  }
  if (drives.empty()) drives.assign(std::begin(kDrives), std::end(kDrives));
  const auto wanted = [&](const char* section) {
    return sections.empty() || std::find(sections.begin(), sections.end(), section) != sections.end();
  };
  if (wanted("errors")) errors(drives);
  if (wanted("drift")) drift(drives, seeds);
  if (wanted("frames")) frames(drives, seeds);
  return 0;
}
