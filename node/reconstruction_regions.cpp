#include "node/reconstruction_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <span>
#include <string_view>

#include "drivers/table.hpp"
#include "fractal/vecchia.hpp"
#include "io/file_bytes.hpp"

namespace scree::node {
namespace {

using fractal::InfluenceCentre;

struct Region {
  InfluenceCentre centre;
  bool estimate = false;
  std::size_t line = 0;
};

Result<double> number_or_auto(std::string_view field, bool& is_auto) {
  is_auto = field == "auto";
  return is_auto ? Result<double>(0.0) : drivers::parse_number(field);
}

Result<std::vector<Region>> read_table(const std::string& file, const io::Raster& place) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 24;
  std::vector<std::uint8_t> bytes;
  if (Status status = io::read_bytes(file, kMostBytes, bytes); !status) return status.error();
  std::vector<Region> regions;
  const auto row = [&](std::size_t line, std::span<const std::string_view> fields) -> Status {
    std::array<double, 4> values{};
    std::array<bool, 4> automatic{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto value = number_or_auto(fields[i], automatic[i]);
      if (!value) return value.error();  // parse_table adds the place
      values[i] = *value;
    }
    if (automatic[0] || automatic[1] || automatic[2] != automatic[3])
      return Error{ErrorKind::bad_data, "expected numbers, or auto for both dimension and amplitude_m, found one auto"};
    regions.push_back(
        {{values[0] - place.x_min_m, values[1] - place.y_min_m, {values[2], values[3]}}, automatic[2], line});
    return {};
  };
  if (Status status = drivers::parse_table(io::as_text(bytes), file, "x_m,y_m,dimension,amplitude_m", row); !status)
    return status.error();
  if (regions.empty())
    return Error{ErrorKind::bad_data, fmt::format("{}: expected a centre behind the header, found none", file)};
  return regions;
}

/// The first of the nearest centres, as the refinement has it.
std::size_t nearest(const std::vector<Region>& regions, double x_m, double y_m) {
  const auto distance2 = [x_m, y_m](const Region& region) {
    const double dx = region.centre.x_m - x_m, dy = region.centre.y_m - y_m;
    return dx * dx + dy * dy;
  };
  const auto closest = std::min_element(regions.begin(), regions.end(),
                                        [&](const Region& a, const Region& b) { return distance2(a) < distance2(b); });
  return static_cast<std::size_t>(closest - regions.begin());
}

Status estimate(const std::string& file, const fractal::HeightSamples& samples, std::size_t index,
                std::vector<Region>& regions) {
  std::vector<double> x_m, y_m, z_m;
  double variance_m2 = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (nearest(regions, samples.x_m[i], samples.y_m[i]) != index) continue;
    x_m.push_back(samples.x_m[i]), y_m.push_back(samples.y_m[i]), z_m.push_back(samples.z_m[i]);
    variance_m2 += samples.variance_m2[i];
  }
  const double noise_m = z_m.empty() ? 0.0 : std::sqrt(variance_m2 / static_cast<double>(z_m.size()));
  const auto found =
      fractal::estimate_dimension_vecchia({.x_m = x_m, .y_m = y_m, .z_m = z_m, .noise_sigma_m = noise_m});
  Region& region = regions[index];
  if (!found) return Error{found.error().kind, fmt::format("{}:{}: {}", file, region.line, found.error().message)};
  if (!std::isfinite(found->dimension))
    return Error{ErrorKind::bad_data, fmt::format("{}:{}: expected samples that tell D, found a noise of {:g} m that "
                                                  "hides it",
                                                  file, region.line, noise_m)};
  region.centre.law = {std::clamp(found->dimension, 2.005, 2.995), found->amplitude_m};
  return {};
}

}  // namespace

Result<std::vector<InfluenceCentre>> read_regions(const std::string& file, const PlacedSurvey& placed) {
  auto regions = read_table(file, placed.place.raster);
  if (!regions) return regions.error();
  std::vector<InfluenceCentre> centres;
  for (std::size_t i = 0; i < regions->size(); ++i) {
    if ((*regions)[i].estimate)
      if (Status status = estimate(file, placed.samples, i, *regions); !status) return status.error();
    centres.push_back((*regions)[i].centre);
  }
  return centres;
}

}  // namespace scree::node
