#include "fractal/reconstruction/outlier_gate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "fractal/reconstruction/blend_fit.hpp"
#include "fractal/reconstruction/box_cascade.hpp"
#include "fractal/reconstruction/varying_prior.hpp"

namespace scree::fractal {
namespace {

constexpr double kDensityReach = 2.0;  // sd of the smoothing over the mean spacing
constexpr int kMaxRadius = 64;
constexpr double kTolerance = 0.05;
// Support: found by experiment on outliers, cliffs and rocks (docs/reconstruction.md).
constexpr std::size_t kNeighbours = 8;
constexpr std::ptrdiff_t kSupporters = 2;
constexpr double kAgree = 2.0, kMuchLess = 0.33, kReach = 3.0;  // standard deviations, share, spacings

/// Squared error of a prediction from data around, at a cell chosen at random, over the squared change across one
/// spacing: .11 … .48 at D = 2.2 … 2.8, a straight line within .02 (docs/reconstruction.md).
double predicted_share(double dimension) {
  return std::clamp(0.61 * dimension - 1.23, 0.02, 0.6);
}

struct Datum {
  int row, column;
  double height;     // from the data's mean, in units of the middle law
  double allowance;  // s, in the same unit
  double weight = 1.0;
};

std::vector<Datum> allow(const CellSamples& samples, double cell_m, const LawMap& law, double ground_share) {
  const int rows = samples.height_m.rows(), columns = samples.height_m.columns();
  std::vector<Datum> data;
  double sum = 0.0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      if (std::isfinite(samples.height_m(r, c))) {
        data.push_back({r, c, static_cast<double>(samples.height_m(r, c)), 0.0});
        sum += data.back().height;
      }
  BoxCascade density;
  const double mean_density = static_cast<double>(data.size()) / static_cast<double>(samples.height_m.size());
  density.resize(rows, columns,
                 std::min(BoxCascade::radius_of(kDensityReach / std::sqrt(std::max(mean_density, 1e-9))), kMaxRadius));
  for (const Datum& datum : data) density.row(datum.row)[static_cast<std::size_t>(datum.column)] = 1.0F;
  density.smooth();

  const double unit = law.law.rms_change_m(cell_m);
  for (Datum& datum : data) {
    const auto c = static_cast<std::size_t>(datum.column);
    const double rho = static_cast<double>(density.smoothed(datum.row)[c]) /
                       static_cast<double>(density.weight_of_row(datum.row) * density.weight_of_columns()[c]);
    const FractalLaw here = law.at(datum.row, datum.column);
    const double ground = here.rms_change_m(cell_m / std::sqrt(std::min(rho, 1.0)));
    const double own = static_cast<double>(samples.variance_m2(datum.row, datum.column));
    datum.height = (datum.height - sum / static_cast<double>(data.size())) / unit;
    datum.allowance = std::sqrt(own + ground_share * predicted_share(here.dimension) * ground * ground) / unit;
  }
  return data;
}

/// Whether at least kSupporters of the nearest kNeighbours data go with this one: their heights differ by what the
/// ground allows at that distance, and by much less than the fit does.
bool supported(const CellSamples& samples, double cell_m, const FractalLaw& here, int reach, int row, int column,
               double off_m) {
  struct Neighbour {
    int distance2;
    bool agrees;
  };
  std::vector<Neighbour> near;
  const float height = samples.height_m(row, column), own = samples.variance_m2(row, column);
  for (int r = std::max(0, row - reach); r <= std::min(samples.height_m.rows() - 1, row + reach); ++r)
    for (int c = std::max(0, column - reach); c <= std::min(samples.height_m.columns() - 1, column + reach); ++c) {
      if ((r == row && c == column) || !std::isfinite(samples.height_m(r, c))) continue;
      const int distance2 = (r - row) * (r - row) + (c - column) * (c - column);
      const double ground = here.rms_change_m(cell_m * std::sqrt(distance2));
      const double difference = static_cast<double>(samples.height_m(r, c) - height);
      const double allowed = ground * ground + static_cast<double>(samples.variance_m2(r, c) + own);
      near.push_back({distance2, difference * difference <=
                                     std::min(kAgree * kAgree * allowed, kMuchLess * kMuchLess * off_m * off_m)});
    }
  const auto wanted = near.begin() + static_cast<std::ptrdiff_t>(std::min(near.size(), kNeighbours));
  std::partial_sort(near.begin(), wanted, near.end(),
                    [](const Neighbour& a, const Neighbour& b) { return a.distance2 < b.distance2; });
  return std::count_if(near.begin(), wanted, [](const Neighbour& n) { return n.agrees; }) >= kSupporters;
}

double residual(const BlendFit& fit, const Datum& datum) {
  return (datum.height - static_cast<double>(fit.row(datum.row)[datum.column])) / datum.allowance;
}

}  // namespace

OutlierReport find_outliers(const CellSamples& samples, double cell_m, const LawMap& law,
                            const OutlierOptions& options) {
  const int rows = samples.height_m.rows(), columns = samples.height_m.columns();
  OutlierReport report{Grid<std::uint8_t>(rows, columns, 0)};
  std::vector<Datum> data = allow(samples, cell_m, law, options.ground_share);
  report.tested = data.size();
  if (data.empty()) return report;
  const double spacing = std::sqrt(static_cast<double>(samples.height_m.size()) / static_cast<double>(data.size()));
  const double dimension = std::clamp(law.law.dimension, 2.05, 2.95);
  BlendFit fit(rows, columns);
  fit.prior().uniform = blend_weights(dimension, blend_wavenumber(dimension, spacing));
  if (law.varies())
    VaryingPrior().set(law, {{0, 0}, rows, columns}, {law.law.rms_change_m(cell_m), cell_m, spacing}, fit.shape(),
                       fit.prior());
  const auto solve = [&] {
    for (const Datum& d : data)
      fit.set_datum(d.row, d.column, static_cast<float>(d.height),
                    static_cast<float>(d.weight / (d.allowance * d.allowance)));
    fit.solve(kTolerance);
  };
  for (int step = 0; step < options.steps; ++step) {
    solve();
    for (Datum& d : data) {
      const double r = residual(fit, d);
      d.weight = (options.freedom + 1.0) / (options.freedom + r * r);
    }
  }
  solve();
  const double unit = law.law.rms_change_m(cell_m);
  const int reach = static_cast<int>(std::ceil(kReach * spacing));
  for (const Datum& d : data) {
    const double r = residual(fit, d);
    if (std::abs(r) <= options.limit) continue;
    if (supported(samples, cell_m, law.at(d.row, d.column), reach, d.row, d.column, r * d.allowance * unit)) {
      ++report.supported;
      continue;
    }
    report.rejected(d.row, d.column) = 1;
    ++report.count;
  }
  report.iterations = fit.iterations();
  return report;
}

CellSamples without_outliers(const CellSamples& samples, const OutlierReport& report) {
  assert(report.rejected.size() == samples.height_m.size());
  CellSamples out = samples;
  for (std::size_t i = 0; i < report.rejected.size(); ++i) {
    if (report.rejected[i] == 0) continue;
    out.height_m[i] = out.variance_m2[i] = std::numeric_limits<float>::quiet_NaN();
    --out.cells;
  }
  return out;
}

}  // namespace scree::fractal
