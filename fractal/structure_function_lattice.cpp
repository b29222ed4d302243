// Pair sums on a lattice: offsets from autocorrelations, gathered in annuli.

#include <algorithm>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <limits>
#include <utility>

#include "fractal/annulus_rule.hpp"
#include "fractal/fourier.hpp"
#include "fractal/lattice_correlation.hpp"
#include "fractal/pair_routes.hpp"

namespace scree::fractal {
namespace {

using Complex = std::complex<double>;
constexpr double kMaxCells = 1 << 25;  // 1.3 GB of transforms
constexpr int kBlock = 8;              // offsets y gathered together: whole cache lines on the strided side

/// Adds the offsets (y, x), y = 0 … reach, |x| ≤ reach, half a plane, to their annuli.
class OffsetBins {
 public:
  OffsetBins(const LatticeShape& shape, const Annuli& annuli, double cell_m)
      : shape_(shape), annuli_(annuli), rule_(annuli), cell_m_(cell_m), scale_(1.0 / shape.side_x / shape.side_y) {}

  void add_row(int y, const Complex* line, std::vector<PairSums>& sums) const {
    for (int x = y == 0 ? 1 : -shape_.reach_columns; x <= shape_.reach_columns; ++x) {
      const Complex value = line[x < 0 ? x + shape_.side_x : x] * scale_;
      const double pairs = std::round(value.imag());
      if (pairs < 1.0) continue;
      const double dx = x * cell_m_, dy = y * cell_m_;
      const int key = annulus_of(rule_, annuli_.spacing, static_cast<float>(dx), static_cast<float>(dy));
      if (key == annuli_.count) continue;
      auto& sum = sums[static_cast<std::size_t>(key)];
      sum.count += pairs;
      sum.square_m2 += std::max(0.0, value.real());
      sum.log_m += pairs * 0.5 * std::log(dx * dx + dy * dy);
    }
  }

 private:
  const LatticeShape& shape_;
  const Annuli& annuli_;
  AnnulusRule rule_;
  double cell_m_, scale_;
};

StructureFunction correlate(const LatticeShape& shape, const LatticeDeposit& deposit, const Annuli& annuli,
                            double cell_m, Executor& executor) {
  const Grid<Complex> columns = lattice_correlation(shape, deposit, executor);
  const OffsetBins bins(shape, annuli, cell_m);
  const int offsets = shape.reach_rows + 1, blocks = (offsets + kBlock - 1) / kBlock, half = shape.side_x / 2;
  std::vector<std::vector<PairSums>> parts(static_cast<std::size_t>(blocks),
                                           std::vector<PairSums>(static_cast<std::size_t>(annuli.count)));
  executor.for_ranges(blocks, [&](int begin, int end) {
    Dft<double> dft(shape.side_x);
    const auto side = static_cast<std::size_t>(shape.side_x);
    std::vector<Complex> block(side * kBlock), out(side);
    for (int b = begin; b < end; ++b) {
      const int first = b * kBlock, count = std::min(kBlock, offsets - first);
      for (int x = 0; x <= half; ++x)
        for (int k = 0; k < count; ++k) {
          const int y = first + k, mirrored_y = y == 0 ? 0 : shape.side_y - y;
          Complex* line = block.data() + static_cast<std::size_t>(k) * side;
          line[x] = columns(x, y);
          if (x > 0 && x < half) line[shape.side_x - x] = columns(x, mirrored_y);
        }
      for (int k = 0; k < count; ++k) {
        dft.forward(block.data() + static_cast<std::size_t>(k) * side, out.data());
        bins.add_row(first + k, out.data(), parts[static_cast<std::size_t>(b)]);
      }
    }
  });
  StructureFunction result{annuli, std::vector<PairSums>(static_cast<std::size_t>(annuli.count)), false};
  for (const auto& part : parts) add_sums(result.sums, part);
  for (auto& sums : result.sums) sums.abs_m = std::numeric_limits<double>::quiet_NaN();
  return result;
}

Status check_size(double rows, double columns, double reach_cells) {
  const double reach_y = std::min(reach_cells, rows), reach_x = std::min(reach_cells, columns);
  if ((rows + reach_y) * (columns + reach_x) <= kMaxCells) return {};
  return Error{
      ErrorKind::bad_data,
      fmt::format("structure function: expected a lattice of at most {:.0f} cells with its margin, found {:.0f} "
                  "x {:.0f} cells and a margin of {:.0f}; take coarser cells or shorter distances",
                  kMaxCells, rows, columns, reach_cells)};
}

}  // namespace

Result<StructureFunction> lattice_pairs(const PointColumns& points, const Annuli& annuli, double cell_m,
                                        Executor& executor) {
  const auto [x0, x1] = std::minmax_element(points.x_m.begin(), points.x_m.end());
  const auto [y0, y1] = std::minmax_element(points.y_m.begin(), points.y_m.end());
  const double x_min = *x0, y_min = *y0, reach_cells = annuli.outer_m(annuli.count - 1) / cell_m;
  const double columns = std::round((*x1 - x_min) / cell_m) + 1.0, rows = std::round((*y1 - y_min) / cell_m) + 1.0;
  if (Status status = check_size(rows, columns, reach_cells); !status) return status.error();
  const LatticeShape shape(static_cast<int>(rows), static_cast<int>(columns), reach_cells);
  double mean = 0.0;
  for (const float z : points.z_m) mean += z;
  mean /= static_cast<double>(points.size());
  LatticeDeposit deposit{{shape.rows, shape.columns}, {shape.rows, shape.columns}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int r = static_cast<int>(std::round((points.y_m[i] - y_min) / cell_m));
    const int c = static_cast<int>(std::round((points.x_m[i] - x_min) / cell_m));
    const double z = points.z_m[i] - mean;
    deposit.count_square(r, c) += Complex{1.0, z * z};
    deposit.sum(r, c) += z;
  }
  return correlate(shape, deposit, annuli, cell_m, executor);
}

Result<StructureFunction> lattice_structure_function(const Grid<float>& height_m, double cell_m, const Annuli& annuli,
                                                     Executor& executor) {
  if (Status status = check_annuli(annuli); !status) return status.error();
  if (!(cell_m > 0.0 && std::isfinite(cell_m)))
    return Error{ErrorKind::usage, fmt::format("structure function: expected a finite cell_m > 0, found {}", cell_m)};
  const double reach_cells = annuli.outer_m(annuli.count - 1) / cell_m;
  if (Status status = check_size(height_m.rows(), height_m.columns(), reach_cells); !status) return status.error();
  double mean = 0.0, known = 0.0;
  for (const float z : height_m)
    if (std::isfinite(z)) mean += z, known += 1.0;
  if (known < 2.0)
    return Error{ErrorKind::bad_data,
                 fmt::format("structure function: expected at least 2 known heights, found {:.0f}", known)};
  mean /= known;
  const LatticeShape shape(height_m.rows(), height_m.columns(), reach_cells);
  LatticeDeposit deposit{{shape.rows, shape.columns}, {shape.rows, shape.columns}};
  for (std::size_t i = 0; i < height_m.size(); ++i)
    if (std::isfinite(height_m[i])) {
      const double z = height_m[i] - mean;
      deposit.count_square[i] = {1.0, z * z};
      deposit.sum[i] = z;
    }
  return correlate(shape, deposit, annuli, cell_m, executor);
}

}  // namespace scree::fractal
