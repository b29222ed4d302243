#include "fractal/reconstruction/intrinsic_kriging.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

SCREE_CLONES void add_scaled_row(double factor, const double* __restrict from, double* __restrict to, int n) {
  for (int i = 0; i < n; ++i) to[i] -= factor * from[i];
}

}  // namespace

IntrinsicKriging::IntrinsicKriging(double hurst, int rows, int columns, std::vector<CellIndex> places)
    : columns_(columns),
      places_(std::move(places)),
      hurst_(hurst),
      centre_x_(0.5 * columns - 0.25),
      centre_y_(0.5 * rows - 0.25),
      shift_(std::pow(std::hypot(rows, columns), 2.0 * hurst)),
      half_variogram_(rows, 2 * columns - 1) {
  for (int dy = 0; dy < rows; ++dy)
    for (int dx = -columns + 1; dx < columns; ++dx)
      half_variogram_(dy, dx + columns - 1) = 0.5 * std::pow(std::hypot(dx, dy), 2.0 * hurst);
  for (const CellIndex place : places_) potential_.push_back(about_centre(place));
}

/// ½·r^(2H) from a point in the middle of the lattice. s² + f(p) + f(q) − ½·r^(2H) with this f is the covariance of fBm
/// that starts there at a random height, hence positive definite; with an unknown constant f and s² cancel.
double IntrinsicKriging::about_centre(CellIndex cell) const {
  return 0.5 * std::pow(std::hypot(cell.x - centre_x_, cell.y - centre_y_), 2.0 * hurst_);
}

Result<IntrinsicKriging> IntrinsicKriging::make(double hurst, int rows, int columns, std::vector<CellIndex> places,
                                                std::span<const double> noise) {
  IntrinsicKriging out(hurst, rows, columns, std::move(places));
  const auto n = static_cast<Eigen::Index>(out.places_.size());
  out.factor_.resize(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j; i < n; ++i) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      const CellIndex p = out.places_[a], q = out.places_[b];
      out.factor_(i, j) = out.shift_ + out.potential_[a] + out.potential_[b] - out.half_variogram(p.x - q.x, p.y - q.y);
    }
  for (Eigen::Index i = 0; i < n; ++i) out.factor_(i, i) += noise[static_cast<std::size_t>(i)];
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(out.factor_);
  if (in_place.info() != Eigen::Success)
    return Error{
        ErrorKind::internal,
        fmt::format("kriging: the covariance of {} heights is singular in double precision (H = {})", n, hurst)};
  out.whitened_ones_ = out.factor_.triangularView<Eigen::Lower>().solve(Eigen::VectorXd::Ones(n));
  return out;
}

IntrinsicKriging::Weights IntrinsicKriging::weights_of(const Eigen::MatrixXd& data) const {
  const auto lower = factor_.triangularView<Eigen::Lower>();
  Weights weights;
  const Eigen::MatrixXd white = lower.solve(data);
  const Eigen::RowVectorXd constant = whitened_ones_.transpose() * white / whitened_ones_.squaredNorm();
  weights.alpha = lower.transpose().solve(white - whitened_ones_ * constant);
  const Eigen::Map<const Eigen::VectorXd> potential(potential_.data(), static_cast<Eigen::Index>(potential_.size()));
  weights.level = constant + potential.transpose() * weights.alpha;
  return weights;
}

void IntrinsicKriging::mean_row(const Weights& weights, Eigen::Index set, int row, double* out) const {
  std::fill_n(out, columns_, weights.level(set));
  for (std::size_t i = 0; i < places_.size(); ++i)
    add_scaled_row(weights.alpha(static_cast<Eigen::Index>(i), set),
                   &half_variogram_(std::abs(row - places_[i].y), columns_ - 1 - places_[i].x), out, columns_);
}

void IntrinsicKriging::deviations(std::span<const CellIndex> cells, double* out) const {
  const auto n = static_cast<Eigen::Index>(places_.size());
  Eigen::MatrixXd block;
  for (std::size_t first = 0; first < cells.size(); first += kBlock) {
    const auto here = cells.subspan(first, std::min<std::size_t>(kBlock, cells.size() - first));
    block.resize(n, static_cast<Eigen::Index>(here.size()));
    for (std::size_t c = 0; c < here.size(); ++c) {
      const double own = shift_ + about_centre(here[c]);
      for (Eigen::Index i = 0; i < n; ++i) {
        const CellIndex p = places_[static_cast<std::size_t>(i)];
        block(i, static_cast<Eigen::Index>(c)) =
            own + potential_[static_cast<std::size_t>(i)] - half_variogram(p.x - here[c].x, p.y - here[c].y);
      }
    }
    factor_.triangularView<Eigen::Lower>().solveInPlace(block);
    for (std::size_t c = 0; c < here.size(); ++c) {
      const auto white = block.col(static_cast<Eigen::Index>(c));
      const double missing = 1.0 - whitened_ones_.dot(white);
      const double variance =
          shift_ + 2.0 * about_centre(here[c]) - white.squaredNorm() + missing * missing / whitened_ones_.squaredNorm();
      out[first + c] = std::sqrt(std::max(0.0, variance));
    }
  }
}

}  // namespace scree::fractal
