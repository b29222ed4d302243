#include "fractal/fbm_points.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <fmt/format.h>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kDrawStream = 0x66626d2d706f696e;  // "fbm-poin"

Status check(const FractalLaw& law, std::span<const double> x_m, std::span<const double> y_m) {
  const auto usage = [](std::string message) { return Error{ErrorKind::usage, std::move(message)}; };
  if (!(law.dimension >= 2.01 && law.dimension <= 2.99))
    return usage(fmt::format("fBm at points: expected 2.01 <= D <= 2.99, found D = {}", law.dimension));
  if (!(law.amplitude_m > 0.0 && std::isfinite(law.amplitude_m)))
    return usage(fmt::format("fBm at points: expected a finite amplitude_m > 0, found {}", law.amplitude_m));
  if (x_m.size() != y_m.size() || x_m.size() < 2 || x_m.size() > FbmPoints::kMaxPoints)
    return usage(fmt::format("fBm at points: expected 2 to {} points, found {} x and {} y", FbmPoints::kMaxPoints,
                             x_m.size(), y_m.size()));
  return {};
}

}  // namespace

Result<FbmPoints> FbmPoints::make(const FractalLaw& law, std::span<const double> x_m, std::span<const double> y_m) {
  if (Status status = check(law, x_m, y_m); !status) return status.error();
  const auto n = static_cast<Eigen::Index>(x_m.size()) - 1;
  const double amplitude2 = law.amplitude_m * law.amplitude_m;
  const auto variogram = [&](Eigen::Index i, Eigen::Index j) {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    return amplitude2 * std::pow(std::hypot(x_m[a] - x_m[b], y_m[a] - y_m[b]), 2.0 * law.hurst());
  };
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j; i < n; ++i)
      covariance(i, j) = 0.5 * (variogram(i + 1, 0) + variogram(j + 1, 0) - variogram(i + 1, j + 1));
  const Eigen::LLT<Eigen::MatrixXd> cholesky(covariance);
  if (cholesky.info() != Eigen::Success)
    return Error{ErrorKind::usage,
                 fmt::format("fBm at points: expected a positive definite covariance of {} finite points at different "
                             "places, found one that is singular",
                             x_m.size())};
  FbmPoints out;
  out.factor_ = cholesky.matrixL();
  return out;
}

std::vector<double> FbmPoints::draw(std::uint64_t seed) const {
  Eigen::VectorXd white(factor_.rows());
  for (Eigen::Index i = 0; i < white.size(); ++i)
    white[i] = random_normals(seed, kDrawStream, static_cast<std::int32_t>(i / 2), 0)[static_cast<std::size_t>(i % 2)];
  const Eigen::VectorXd heights = factor_.triangularView<Eigen::Lower>() * white;
  std::vector<double> out(static_cast<std::size_t>(white.size()) + 1, 0.0);
  for (Eigen::Index i = 0; i < white.size(); ++i) out[static_cast<std::size_t>(i) + 1] = heights[i];
  return out;
}

}  // namespace scree::fractal
