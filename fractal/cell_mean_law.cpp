#include "fractal/cell_mean_law.hpp"

#include <algorithm>
#include <cmath>

#include "fractal/support.hpp"

namespace scree::fractal {
namespace {

constexpr float kFirst = 0.05F, kStep = 0.025F;

}  // namespace

CellMeanLaw::Values CellMeanLaw::exact(double hurst) {
  const double inside = mean_variogram(Support::block, hurst, 0, 0);
  const double near = mean_variogram(Support::block, hurst, kNear, 0) - inside;
  const double far = mean_variogram(Support::block, hurst, kFar, 0) - inside;
  return {static_cast<float>(0.5 * std::log(far / near) / std::log(static_cast<double>(kFar) / kNear)),
          static_cast<float>(std::sqrt(near)), static_cast<float>(0.5 * inside)};
}

CellMeanLaw::CellMeanLaw() {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    nodes_[i] = exact(static_cast<double>(kFirst) + static_cast<double>(kStep) * static_cast<double>(i));
}

const CellMeanLaw& CellMeanLaw::instance() {
  static const CellMeanLaw law;
  return law;
}

CellMeanLaw::Values CellMeanLaw::at(float hurst) const {
  const float place = std::clamp((hurst - kFirst) / kStep, 0.0F, static_cast<float>(kNodes - 1));
  const auto node = std::min(static_cast<std::size_t>(place), nodes_.size() - 2);
  const float t = place - static_cast<float>(node);
  const Values &a = nodes_[node], &b = nodes_[node + 1];
  return {a.hurst + t * (b.hurst - a.hurst), a.change + t * (b.change - a.change),
          a.within + t * (b.within - a.within)};
}

}  // namespace scree::fractal
