#include "fractal/reconstruction/relative_pyramid.hpp"

#include <algorithm>
#include <cmath>

#include "fractal/reconstruction/temperature.hpp"

namespace scree::fractal {
namespace {

constexpr double kMaxPrecision = 1e6;  // of a datum over that of one cell's change: floats hold no more

RelativePyramid::Level finest_level(const CellSamples& samples, RelativePyramid& pyramid) {
  const int rows = samples.height_m.rows(), columns = samples.height_m.columns();
  RelativePyramid::Level level;
  level.gibbs.precision.assign(rows, columns, 0.0F);
  level.datum.assign(rows, columns, 0.0F);
  const double unit2 = pyramid.unit_m * pyramid.unit_m;
  double weight = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < samples.height_m.size(); ++i) {
    if (std::isnan(samples.height_m[i])) continue;
    const double c = std::min(kMaxPrecision, unit2 / static_cast<double>(samples.variance_m2[i]));
    level.gibbs.precision[i] = static_cast<float>(c);
    weight += c;
    sum += c * static_cast<double>(samples.height_m[i]);
  }
  pyramid.offset_m = sum / weight;
  for (std::size_t i = 0; i < samples.height_m.size(); ++i)
    if (!std::isnan(samples.height_m[i]))
      level.datum[i] =
          static_cast<float>((static_cast<double>(samples.height_m[i]) - pyramid.offset_m) / pyramid.unit_m);
  return level;
}

RelativePyramid::Level coarser_level(const RelativePyramid::Level& fine) {
  const int rows = (fine.datum.rows() + 1) / 2, columns = (fine.datum.columns() + 1) / 2;
  RelativePyramid::Level level;
  level.gibbs.precision.assign(rows, columns, 0.0F);
  level.datum.assign(rows, columns, 0.0F);
  for (int r = 0; r < fine.datum.rows(); ++r)
    for (int c = 0; c < fine.datum.columns(); ++c) {
      level.gibbs.precision(r / 2, c / 2) += fine.gibbs.precision(r, c);
      level.datum(r / 2, c / 2) += fine.gibbs.precision(r, c) * fine.datum(r, c);
    }
  for (std::size_t i = 0; i < level.datum.size(); ++i)
    if (level.gibbs.precision[i] > 0.0F) level.datum[i] /= level.gibbs.precision[i];
  return level;
}

}  // namespace

RelativePyramid make_pyramid(const CellSamples& samples, const FractalLaw& law, double cell_m,
                             double relative_temperature) {
  RelativePyramid pyramid;
  pyramid.unit_m = law.rms_change_m(cell_m);
  pyramid.levels.push_back(finest_level(samples, pyramid));
  while (std::max(pyramid.levels.back().datum.rows(), pyramid.levels.back().datum.columns()) > 2)
    pyramid.levels.push_back(coarser_level(pyramid.levels.back()));
  double temperature = relative_temperature;
  for (RelativePyramid::Level& level : pyramid.levels) {
    const double k2 = kSzeliskiWavenumber * kSzeliskiWavenumber;
    level.gibbs.weights = {static_cast<float>((law.dimension - 2.0) / k2 / temperature),
                           static_cast<float>((3.0 - law.dimension) / (k2 * k2) / temperature)};
    level.gibbs.finish();
    temperature *= std::exp2(2.0 * law.hurst());
  }
  return pyramid;
}

void interpolate(const Grid<float>& coarse, Grid<float>& fine) {
  const auto away = [](int i, int n) { return std::clamp(i % 2 ? i / 2 + 1 : i / 2 - 1, 0, n - 1); };
  for (int r = 0; r < fine.rows(); ++r) {
    const auto near_row = coarse.row(r / 2), away_row = coarse.row(away(r, coarse.rows()));
    for (int c = 0; c < fine.columns(); ++c) {
      const auto near = static_cast<std::size_t>(c / 2), far = static_cast<std::size_t>(away(c, coarse.columns()));
      fine(r, c) = 0.75F * (0.75F * near_row[near] + 0.25F * near_row[far]) +
                   0.25F * (0.75F * away_row[near] + 0.25F * away_row[far]);
    }
  }
}

}  // namespace scree::fractal
