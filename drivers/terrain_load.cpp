#include "drivers/terrain_load.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

#include "drivers/simulator_grammar.hpp"
#include "fractal/surface.hpp"
#include "io/point_cloud.hpp"

namespace scree::drivers {
namespace {

constexpr std::string_view kFractalPrefix = "fbm:";
constexpr int kMostCells = 8192;  // a side; the synthesis needs some 100 bytes for each
constexpr std::array<std::string_view, 6> kPointFiles{".bin", ".pcd", ".ply", ".xyz", ".txt", ".csv"};

/// The third field alone is an integer: a seed beyond 2^53 must not lose its low bits in a double.
Result<std::uint64_t> parse_seed(std::string_view numbers) {
  std::string_view field = numbers;
  for (int skipped = 0; skipped < 2; ++skipped) field.remove_prefix(std::min(field.find(',') + 1, field.size()));
  field = field.substr(0, field.find(','));
  std::uint64_t seed = 0;
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), seed);
  if (status != std::errc{} || end != field.data() + field.size())
    return grammar_error(kTerrainGrammar, numbers, fmt::format("'{}' is not a seed 0 … 2^64−1", field));
  return seed;
}

Result<Terrain> fractal_terrain(std::string_view specification) {
  const auto text = specification.substr(kFractalPrefix.size());
  const auto numbers = parse_numbers(text, 3, 5, kTerrainGrammar);
  if (!numbers) return numbers.error();
  const auto seed = parse_seed(text);
  if (!seed) return seed.error();
  const fractal::FractalLaw law{(*numbers)[0], (*numbers)[1]};
  const double extent_m = numbers->size() > 3 ? (*numbers)[3] : 60.0;
  const double cell_m = numbers->size() > 4 ? (*numbers)[4] : 0.05;
  const auto wrong = [&](std::string_view reason) { return grammar_error(kTerrainGrammar, specification, reason); };
  if (!(law.dimension > 2.0 && law.dimension < 3.0)) return wrong("D must be between 2 and 3");
  if (!(law.amplitude_m > 0.0)) return wrong("AMPLITUDE_M must be positive");
  if (!(extent_m > 0.0 && cell_m > 0.0)) return wrong("EXTENT_M and CELL_M must be positive");
  const double cells = std::round(extent_m / cell_m);
  if (!(cells >= 2.0 && cells <= kMostCells))
    return wrong(fmt::format("EXTENT_M / CELL_M is {:.0f}, must be 2 … {}", cells, kMostCells));

  const int side = static_cast<int>(cells);
  auto surface = fractal::fbm_surface(law, side, side, cell_m, *seed);
  if (!surface) return surface.error();
  const float middle = (*surface)(side / 2, side / 2);
  for (float& height : *surface) height -= middle;
  io::Raster raster;
  raster.height_m = *std::move(surface);
  raster.cell_m = raster.cell_y_m = cell_m;
  raster.x_min_m = raster.y_min_m = -0.5 * side * cell_m;
  return Terrain::make(std::move(raster), std::string(specification));
}

}  // namespace

Result<Terrain> load_terrain(std::string_view specification, const SurveyGridding& gridding) {
  if (specification.empty()) return grammar_error(kTerrainGrammar, specification, "nothing given");
  if (specification.starts_with(kFractalPrefix)) return fractal_terrain(specification);
  const std::filesystem::path file(specification);
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (std::find(kPointFiles.begin(), kPointFiles.end(), extension) == kPointFiles.end()) {
    auto raster = io::read_raster(file);
    if (!raster) return raster.error();
    return Terrain::make(*std::move(raster), file.string());
  }
  const auto cloud = io::read_point_cloud(file);
  if (!cloud) return cloud.error();
  auto raster = grid_survey(cloud->points, cloud->origin_m, gridding, file.string());
  if (!raster) return raster.error();
  return Terrain::make(*std::move(raster), file.string());
}

}  // namespace scree::drivers
