#include "fractal/energy_planes.hpp"

#include <algorithm>
#include <cmath>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

/// Fewer increments than this in a direction, and it is not compared with the other.
constexpr float kMinDirectionCount = 8.0F;
/// Energies below this count as none.
constexpr float kNoEnergy = 1e-36F;
constexpr float kLogNoEnergy = -80.0F;

SCREE_INLINE void log_lanes(const Lanes& x, Lanes& out) {
  const Lanes floor = kNoEnergy + Lanes{};
  fast_log<Lanes, IntLanes>(x > floor ? x : floor, out);
}

/// Mean energies of eight cells to their logarithms; an energy of zero becomes log 1e-36.
SCREE_INLINE void log_of_mean(float* energy, const float* count) {
  Lanes e, k;
  std::memcpy(&e, energy, sizeof e);
  std::memcpy(&k, count, sizeof k);
  const Lanes one = 1.0F + Lanes{};
  log_lanes(e / (k > one ? k : one), e);
  std::memcpy(energy, &e, sizeof e);
}

/// Sums of two directions to the log ratio of their means (in e2; 0 where a direction has too few), and energy and
/// count of both (in e1, k1). Eight cells.
SCREE_INLINE void combine(float* e1, float* e2, float* k1, const float* k2) {
  Lanes ea, eb, ka, kb;
  std::memcpy(&ea, e1, sizeof ea);
  std::memcpy(&eb, e2, sizeof eb);
  std::memcpy(&ka, k1, sizeof ka);
  std::memcpy(&kb, k2, sizeof kb);
  const Lanes least = kMinDirectionCount + Lanes{}, floor = kNoEnergy + Lanes{}, one = 1.0F + Lanes{};
  const IntLanes valid = (ka >= least) & (kb >= least) & (ea > floor) & (eb > floor);
  Lanes ratio = valid ? (ea * kb) / (eb * ka) : one;
  fast_log<Lanes, IntLanes>(ratio, ratio);
  ea += eb;
  ka += kb;
  std::memcpy(e1, &ea, sizeof ea);
  std::memcpy(e2, &ratio, sizeof ratio);
  std::memcpy(k1, &ka, sizeof ka);
}

SCREE_INLINE void eight_to_logarithms(float* e1, float* e2, float* k1, const float* k2) {
  if (e2 != nullptr) combine(e1, e2, k1, k2);
  log_of_mean(e1, k1);
}

/// Sums of energies and counts of the one or two planes of a class (e2 null: one), in place.
SCREE_CLONES void to_logarithms(float* e1, float* e2, float* k1, float* k2, std::size_t n) {
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) eight_to_logarithms(e1 + i, e2 ? e2 + i : nullptr, k1 + i, k2 ? k2 + i : nullptr);
  const std::array<float*, 4> planes = {e1, e2, k1, k2};
  std::array<std::array<float, 8>, 4> rest{};
  for (std::size_t p = 0; p < planes.size(); ++p)
    if (planes[p] != nullptr) std::copy(planes[p] + i, planes[p] + n, rest[p].begin());
  eight_to_logarithms(rest[0].data(), e2 ? rest[1].data() : nullptr, rest[2].data(), rest[3].data());
  for (std::size_t p = 0; p < planes.size(); ++p)
    if (planes[p] != nullptr) std::copy_n(rest[p].begin(), n - i, planes[p] + i);
}

}  // namespace

void EnergyPlanes::sum_plane(int c, int direction, int plane, BoxScratch& scratch) {
  BoxSum& energy = energies_[static_cast<std::size_t>(plane)];
  BoxSum& count = counts_[static_cast<std::size_t>(plane)];
  for (int r = 0; r < heights_.rows; ++r)
    if (const BitPlane::Span span = changed_increments_.span(r); span.begin < span.end)
      increment_energies(heights_, kClasses[static_cast<std::size_t>(c)], direction, r, span.begin, span.end,
                         energy.row(r), count.row(r));
  energy.sum(scratch);
  count.sum(scratch);
}

void EnergyPlanes::sum_class(int c, BoxScratch& scratch) {
  const int first = first_plane(c);
  const auto at = static_cast<std::size_t>(first);
  const std::size_t cells = counts_[at].sums().size();
  float* energy = energies_[at].sums().data();
  float* count = counts_[at].sums().data();
  if (c < kContrastClassCount) {
    sum_plane(c, 0, first, scratch);
    sum_plane(c, 1, first + 1, scratch);
    to_logarithms(energy, energies_[at + 1].sums().data(), count, counts_[at + 1].sums().data(), cells);
  } else {
    sum_plane(c, kAllDirections, first, scratch);
    to_logarithms(energy, nullptr, count, nullptr, cells);
  }
}

void EnergyPlanes::update(const CellHeights& cells, Executor& executor) {
  find_changes(cells);
  if (!changed_windows_.any()) return;
  executor.for_ranges(kClassCount + 1, [&](int begin, int end) {
    for (int task = begin; task < end; ++task) {
      BoxScratch& scratch = scratch_[static_cast<std::size_t>(task)];
      if (task < kClassCount)
        sum_class(task, scratch);
      else
        for (BoxSum* plane : {&known_, &variance_, &inverse_hits_}) plane->sum(scratch);
    }
  });
}

void EnergyPlanes::set_shares(std::size_t cell, EnergyWindow& out) const {
  for (int c = 0; c < kClassCount; ++c) {
    const IncrementClass increment_class = kClasses[static_cast<std::size_t>(c)];
    const float points = increment_class.shape == IncrementShape::square ? 4.0F : 3.0F;
    const float expected = static_cast<float>(increment_class.multiplicity()) * out.cells * std::pow(out.fill, points);
    out.share[static_cast<std::size_t>(c)] = counts_[static_cast<std::size_t>(first_plane(c))].sums()[cell] / expected;
  }
}

EnergyPlanes::Content EnergyPlanes::window(std::size_t cell, int min_effective_cells, EnergyWindow& out,
                                           float& log_unit) const {
  const float complete = 0.5F * counts_[0].sums()[cell];  // axis increments of step 1, both directions
  if (complete < std::max(1.0F, static_cast<float>(min_effective_cells))) return Content::too_little;
  log_unit = energies_[0].sums()[cell];
  if (log_unit < kLogNoEnergy) return Content::flat;
  out.missing = 0;
  for (int c = 0; c < kClassCount; ++c) {
    const auto plane = static_cast<std::size_t>(first_plane(c)), lane = static_cast<std::size_t>(c);
    const float log_energy = energies_[plane].sums()[cell];
    const bool present = counts_[plane].sums()[cell] >= 1.0F && log_energy > kLogNoEnergy;
    out.log_energy[lane] = present ? log_energy - log_unit : 0.0F;
    out.missing = static_cast<std::uint8_t>(out.missing | (present ? 0 : 1 << c));
  }
  if (out.missing != 0 && !can_do_without(out.missing)) return Content::too_little;
  for (std::size_t c = 0; c < kContrastClassCount; ++c) out.log_contrast[c] = energies_[2 * c + 1].sums()[cell];
  const float cells = known_.sums()[cell];
  const float noise = variance_.sums()[cell] / cells + rounding_variance_m2_;
  out.noise = noise * fast_exp(-log_unit);
  out.nugget = inverse_hits_.sums()[cell] / cells;
  // A known centre has both axis neighbours with probability fill²: 1 inside a solid patch, p for cells missing at
  // random.
  out.fill = std::min(1.0F, std::sqrt(complete / cells));
  out.cells = cells / out.fill;
  if (out.missing != 0) set_shares(cell, out);
  return Content::rough;
}

}  // namespace scree::fractal
