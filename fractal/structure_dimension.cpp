#include "fractal/structure_dimension.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "fractal/lag_fit.hpp"

namespace scree::fractal {
namespace {

constexpr double kLeastHurst = 0.01, kMostHurst = 0.995;
constexpr double kCoarseStep = 0.02;
constexpr double kInterval = 3.841;  // 95 % of χ²(1)
constexpr int kMaxRounds = 6;
// Beyond it a plane is nearly all there is, and the few waves that are left have no Gaussian errors.
constexpr double kSmoothestWeights = 0.93;
constexpr double kSettled = 1e-3;  // of H between rounds
constexpr double kHidden = 1e-3;   // ground's share of the mean-square change where noise hides it

/// The best amplitude for given H, and what it costs.
struct AtHurst {
  double cost = 0.0;
  double log_c = 0.0;
};

/// One survey's lags under C·γ(H) + noise with fixed weights.
class Profile {
 public:
  Profile(const LagStatistics& statistics, const LagModel& model) : statistics_(statistics), model_(model) {}

  GroundLaw law(double hurst, double c) const {
    return {{c, hurst}, {}, 0.0, statistics_.noise_variance, statistics_.blur};
  }
  void weigh(double hurst, double log_c) { fit_.weigh(model_, law(hurst, std::exp(log_c))); }

  /// Gauss–Newton over ln C, shortened steps; without noise the first is exact.
  AtHurst at(double hurst, double start) const {
    const double noise = 2.0 * (statistics_.noise_variance + statistics_.slope_noise);
    const Eigen::VectorXd unit = model_.expected(law(hurst, 1.0)).array() - noise;
    AtHurst now{0.0, start};
    for (int step = 0; step < 30; ++step) {
      const Eigen::ArrayXd ground = std::exp(now.log_c) * unit.array();
      const Eigen::VectorXd slope = fit_.whitened(ground / (ground + noise));
      const Eigen::VectorXd residual = fit_.residual((ground + noise).log());
      now.cost = residual.squaredNorm();
      const double move = std::clamp(slope.dot(residual) / std::max(slope.squaredNorm(), 1e-300), -1.0, 1.0);
      if (std::abs(move) < 1e-9) break;
      now.log_c += move;
      if (now.log_c < kLeastLogC) break;
    }
    return now;
  }

 private:
  static constexpr double kLeastLogC = -40.0;
  const LagStatistics& statistics_;
  const LagModel& model_;
  LagFit fit_{statistics_};
};

struct Best {
  double hurst = 0.5, log_c = 0.0, cost = 0.0;
};

/// Grid, then golden section between the neighbours of its best.
Best search(const Profile& profile, double start) {
  Best best{.cost = std::numeric_limits<double>::infinity()};
  const auto consider = [&](double hurst) {
    const AtHurst here = profile.at(hurst, start);
    if (here.cost < best.cost) best = {hurst, here.log_c, here.cost};
    return here.cost;
  };
  for (double hurst = kLeastHurst; hurst < kMostHurst + 1e-9; hurst += kCoarseStep)
    consider(std::min(hurst, kMostHurst));
  consider(kMostHurst);
  double low = std::max(kLeastHurst, best.hurst - kCoarseStep), high = std::min(kMostHurst, best.hurst + kCoarseStep);
  constexpr double kGolden = 0.618033988749895;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = consider(a), at_b = consider(b);
  while (high - low > 1e-7) {
    if (at_a < at_b) {
      high = b, b = a, at_b = at_a;
      a = high - kGolden * (high - low), at_a = consider(a);
    } else {
      low = a, a = b, at_a = at_b;
      b = low + kGolden * (high - low), at_b = consider(b);
    }
  }
  return best;
}

/// Where the cost has risen by kInterval on one side of the best H; the bound if it does not.
double limit(const Profile& profile, const Best& best, double bound, bool& open) {
  const double most = best.cost + kInterval;
  open = profile.at(bound, best.log_c).cost <= most;
  if (open) return bound;
  double inside = best.hurst, outside = bound;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (inside + outside);
    (profile.at(middle, best.log_c).cost <= most ? inside : outside) = middle;
  }
  return 0.5 * (inside + outside);
}

/// H with as much likelihood above as below. The most likely H of smooth ground is often the bound itself; the median
/// errs less, and is the same where the likelihood is symmetric.
Best median_of(const Profile& profile, const Best& best, double low, double high) {
  constexpr int kNodes = 60;
  const double from = std::max(kLeastHurst, best.hurst - 2.0 * (best.hurst - low));
  const double to = std::min(kMostHurst, best.hurst + 2.0 * (high - best.hurst));
  std::array<double, kNodes> reached{};  // likelihood summed up to the end of each node
  double weight = 0.0;
  for (int k = 0; k < kNodes; ++k) {
    const double hurst = from + (to - from) * (k + 0.5) / kNodes;
    weight += std::exp(0.5 * (best.cost - profile.at(hurst, best.log_c).cost));
    reached[static_cast<std::size_t>(k)] = weight;
  }
  const auto half = std::lower_bound(reached.begin(), reached.end(), 0.5 * weight) - reached.begin();
  const double before = half > 0 ? reached[static_cast<std::size_t>(half) - 1] : 0.0;
  const double within = (0.5 * weight - before) / (reached[static_cast<std::size_t>(half)] - before);
  const double hurst = from + (to - from) * (static_cast<double>(half) + within) / kNodes;
  const AtHurst there = profile.at(hurst, best.log_c);
  return {hurst, there.log_c, there.cost};
}

DimensionEstimate describe(const Profile& profile, const Best& likeliest, const LagStatistics& statistics) {
  DimensionEstimate out;
  bool low_open = false, high_open = false;
  const double low = limit(profile, likeliest, kLeastHurst, low_open);
  const double high = limit(profile, likeliest, kMostHurst, high_open);
  const Best best = median_of(profile, likeliest, low, high);
  out.dimension = 3.0 - best.hurst;
  out.interval95 = {high_open ? 2.0 : 3.0 - high, low_open ? 3.0 : 3.0 - low};
  if (high_open) out.flags |= kOpenBelow;
  if (low_open) out.flags |= kOpenAbove;
  out.sigma = (high - low) / (2.0 * std::sqrt(kInterval));
  const double c = std::exp(best.log_c);
  out.amplitude_m = std::sqrt(c) * statistics.height_m * std::pow(statistics.spacing_m, -best.hurst);
  out.relative_noise = statistics.noise_variance / c;
  if (out.relative_noise > 1.0) out.flags |= kNoiseHides;
  const double longest = statistics.lags.back().distance;
  if (c * std::pow(longest, 2.0 * best.hurst) < kHidden * statistics.noise_variance) {
    out.dimension = out.sigma = out.amplitude_m = std::numeric_limits<double>::quiet_NaN();
    out.interval95 = {};
    out.flags |= kOpenBelow | kOpenAbove;
  }
  out.lag_min_m = statistics.lags.front().distance * statistics.spacing_m;
  out.lag_max_m = longest * statistics.spacing_m;
  return out;
}

}  // namespace

Result<DimensionEstimate> estimate_dimension_structure(const SurveyPoints& survey,
                                                       const StructureDimensionOptions& options, Executor& executor) {
  const auto statistics = lag_statistics(survey, {options.max_lag_m, options.seed}, executor);
  if (!statistics) return statistics.error();
  const LagModel model(*statistics);
  Profile profile(*statistics, model);
  Best best{.log_c = statistics->lags.front().log_square};
  for (int round = 0; round < kMaxRounds; ++round) {
    const double before = best.hurst;
    const double hurst = std::min(best.hurst, kSmoothestWeights);
    profile.weigh(hurst, round == 0 ? best.log_c : profile.at(hurst, best.log_c).log_c);
    best = search(profile, best.log_c);
    if (std::abs(best.hurst - before) < kSettled) break;
  }
  DimensionEstimate out = describe(profile, best, *statistics);
  out.method = "structure-function";
  out.points = statistics->points;
  out.duplicates = statistics->duplicates;
  if (out.duplicates > 0) out.flags |= kDuplicatesMerged;
  out.spacing_m = statistics->spacing_m;
  out.noise_sigma_m = std::sqrt(statistics->noise_variance + statistics->slope_noise) * statistics->height_m;
  return out;
}

Agreement compare_estimates(const DimensionEstimate& first, const DimensionEstimate& second) {
  Agreement out;
  out.comparable = std::isfinite(first.dimension) && std::isfinite(second.dimension);
  if (!out.comparable) return out;
  out.difference = first.dimension - second.dimension;
  const auto& upper = out.difference >= 0.0 ? first : second;
  const auto& lower = out.difference >= 0.0 ? second : first;
  out.allowed = std::hypot(upper.dimension - upper.interval95.low, lower.interval95.high - lower.dimension);
  out.agree = std::abs(out.difference) <= out.allowed;
  return out;
}

}  // namespace scree::fractal
