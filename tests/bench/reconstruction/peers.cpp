// Other programs on the same samples, where they are installed: tests/bench/peers.

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sys/wait.h>

#include "fractal/axis_dimension.hpp"
#include "fractal/reconstruction/kriging.hpp"
#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "tests/bench/reconstruction/method_scores.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.3, 2.5, 2.7};
constexpr int kSide = 256;
constexpr double kShare = 0.05;

/// What a row of the table holds, a column a D.
struct PeerScore {
  double seconds = 0.0, rmse = 0.0, dimension = 0.0, change = 0.0;
};
struct PeerRow {
  std::string name;
  std::array<PeerScore, kDimensions.size()> scores{};
};

PeerScore score(const SparseScene& scene, const Grid<float>& surface, double seconds) {
  const double unit = scene.law.rms_change_m(kSceneCellM);
  double square = 0.0, cells = 0.0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!std::isnan(scene.height[i]) || std::isnan(surface[i])) continue;
    square += std::pow(static_cast<double>(surface[i] - scene.truth[i]) / unit, 2), cells += 1.0;
  }
  return {seconds, std::sqrt(square / cells), axis_dimension(surface) - axis_dimension(scene.truth),
          rms_increment(surface, 1) / rms_increment(scene.truth, 1)};
}

void write_problem(const SparseScene& scene, const std::filesystem::path& folder) {
  std::ofstream samples(folder / "samples.xyz");
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      if (!std::isnan(scene.height(r, c)))
        samples << fmt::format("{:.6f} {:.6f} {:.8f}\n", (c + 0.5) * kSceneCellM, (r + 0.5) * kSceneCellM,
                               scene.height(r, c));
  std::ofstream(folder / "problem.txt") << fmt::format("{} {} {} {} {} {}\n", kSide, kSide, kSceneCellM,
                                                       scene.law.dimension, scene.law.amplitude_m, scene.sigma);
}

Grid<float> read_surface(const std::filesystem::path& file) {
  Grid<float> surface(kSide, kSide, NAN);
  std::ifstream text(file);
  std::string word;
  for (std::size_t i = 0; i < surface.size() && text >> word; ++i) surface[i] = std::strtof(word.c_str(), nullptr);
  return surface;
}

PeerRow& row_of(std::vector<PeerRow>& rows, const std::string& name) {
  for (PeerRow& row : rows)
    if (row.name == name) return row;
  rows.push_back({name});
  return rows.back();
}

/// Every surface that the script has left in the folder.
void collect(const SparseScene& scene, std::size_t column, const std::filesystem::path& folder,
             std::vector<PeerRow>& rows) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".seconds") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (std::filesystem::path file : files) {
    double seconds = 0.0;
    std::ifstream(file) >> seconds;
    const std::string name = file.stem().string();
    row_of(rows, name).scores[column] = score(scene, read_surface(file.replace_extension(".txt")), seconds);
  }
}

void run_peers(const SparseScene& scene, std::size_t column, std::vector<PeerRow>& rows) {
  constexpr int kSkipped = 77;
  const std::filesystem::path scripts = std::filesystem::path(SCREE_SOURCE_DIR) / "tests/bench/peers";
  for (const char* script : {"gmt_surface.sh", "gstat.R", "grass_rst.sh"}) {
    const test::TemporaryFolder folder;
    write_problem(scene, folder.path());
    const int status = std::system(fmt::format("'{}' '{}' > '{}' 2>&1", (scripts / script).string(),
                                               folder.path().string(), (folder / "log").string())
                                       .c_str());
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
      collect(scene, column, folder.path(), rows);
    else if (column == 0)
      std::fprintf(stderr, "peers: %s %s\n", script,
                   WIFEXITED(status) && WEXITSTATUS(status) == kSkipped ? "skipped: not installed" : "failed");
  }
}

template <class Call>
void run_ours(const SparseScene& scene, std::size_t column, const std::string& name, std::vector<PeerRow>& rows,
              const Call& call) {
  SurfaceRequest request = request_for(scene, 1);
  Grid<float> draw;
  request.on_draw = [&draw](int, const Grid<float>& draw_m) { draw = draw_m; };
  const auto begin = std::chrono::steady_clock::now();
  const SurfaceEstimate estimate = *call(request);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  row_of(rows, name + ", mean").scores[column] = score(scene, estimate.mean_m, taken.count());
  row_of(rows, name + ", draw").scores[column] = score(scene, draw, taken.count());
}

}  // namespace

void peers_section() {
  std::vector<PeerRow> rows;
  SerialExecutor serial;
  for (std::size_t column = 0; column < kDimensions.size(); ++column) {
    const SparseScene scene(kDimensions[column], kSide, kSide, kShare, 1);
    run_ours(scene, column, "conditional", rows, [&](const SurfaceRequest& request) {
      return reconstruct_conditional(cells_of(scene), request, {}, serial);
    });
    run_ours(scene, column, "kriging", rows,
             [&](const SurfaceRequest& request) { return reconstruct_kriging(cells_of(scene), request, {}, serial); });
    run_peers(scene, column, rows);
  }
  print_text("\n## Other programs on the same samples\n");
  print_text(
      fmt::format("One surface a D, {0} x {0} cells, {1:.0f} % of them known: seconds / RMSE in changes over a "
                  "cell / D less the truth's / rms change over a cell over the truth's. Ours: mean, sd from 8 "
                  "fields and one draw together, one core. Theirs: the method alone, set as tests/bench/peers says.\n",
                  kSide, 100.0 * kShare));
  print_head("", kDimensions);
  for (const PeerRow& row : rows)
    print_row(row.name, kDimensions.size(), [&](std::size_t c) {
      const PeerScore& s = row.scores[c];
      return fmt::format("{:.3g} / {:.3f} / {:+.3f} / {:.3f}", s.seconds, s.rmse, s.dimension, s.change);
    });
  print_text("");
}

}  // namespace scree::bench
