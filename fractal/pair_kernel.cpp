#include "fractal/pair_kernel.hpp"

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

constexpr int kStep = 8;      // pairs computed at once; what exceeds the run is overwritten by the next
constexpr int kBuffer = 512;  // pairs between two scatters
constexpr int kLanes = 8;     // histograms: consecutive pairs of one annulus do not wait for each other
constexpr int kFlush = 8192;  // pairs between two flushes: float sums of at most 1024 terms

using Four = float __attribute__((vector_size(16)));

/// Eight pairs' columns to eight pairs' rows {1, |dz|, dz², ln d}.
SCREE_INLINE void store_rows(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d, float* out) {
  const Lanes ab_low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
  const Lanes ab_high = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
  const Lanes cd_low = __builtin_shufflevector(c, d, 0, 8, 1, 9, 2, 10, 3, 11);
  const Lanes cd_high = __builtin_shufflevector(c, d, 4, 12, 5, 13, 6, 14, 7, 15);
  const Lanes row01 = __builtin_shufflevector(ab_low, cd_low, 0, 1, 8, 9, 2, 3, 10, 11);
  const Lanes row23 = __builtin_shufflevector(ab_low, cd_low, 4, 5, 12, 13, 6, 7, 14, 15);
  const Lanes row45 = __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 2, 3, 10, 11);
  const Lanes row67 = __builtin_shufflevector(ab_high, cd_high, 4, 5, 12, 13, 6, 7, 14, 15);
  std::memcpy(out, &row01, sizeof row01);  // one by one: copied as an array they would pass through the stack
  std::memcpy(out + 8, &row23, sizeof row23);
  std::memcpy(out + 16, &row45, sizeof row45);
  std::memcpy(out + 24, &row67, sizeof row67);
}

SCREE_INLINE void add_row(const float* row, float* sum) {
  Four total, value;
  std::memcpy(&total, sum, sizeof total);
  std::memcpy(&value, row, sizeof value);
  total += value;
  std::memcpy(sum, &total, sizeof total);
}

template <Annuli::Spacing kSpacing>
SCREE_INLINE void compute(const AnnulusRule rule, const float* xs, const float* ys, const float* zs, float x, float y,
                          float z, int count, std::int32_t* __restrict keys, float* __restrict values) {
  for (int j = 0; j < count; j += kStep) {
    Lanes dx, dy, dz, log_distance;
    std::memcpy(&dx, xs + j, sizeof dx);
    std::memcpy(&dy, ys + j, sizeof dy);
    std::memcpy(&dz, zs + j, sizeof dz);
    dx -= x, dy -= y, dz -= z;
    IntLanes key;
    find_annulus<kSpacing>(rule, dx * dx + dy * dy, key, log_distance);
    std::memcpy(keys + j, &key, sizeof key);
    const Lanes rise = dz < 0.0F ? -dz : dz;
    store_rows(Lanes{} + 1.0F, rise, dz * dz, log_distance, values + 4 * j);
  }
}

SCREE_CLONES void compute_uniform(const AnnulusRule& rule, const float* xs, const float* ys, const float* zs, float x,
                                  float y, float z, int count, std::int32_t* keys, float* values) {
  compute<Annuli::Spacing::uniform>(rule, xs, ys, zs, x, y, z, count, keys, values);
}

SCREE_CLONES void compute_geometric(const AnnulusRule& rule, const float* xs, const float* ys, const float* zs, float x,
                                    float y, float z, int count, std::int32_t* keys, float* values) {
  compute<Annuli::Spacing::geometric>(rule, xs, ys, zs, x, y, z, count, keys, values);
}

}  // namespace

void PairColumns::resize(int points) {
  count = points;
  for (auto* column : {&x, &y, &z}) column->assign(static_cast<std::size_t>(points + kPad), 0.0F);
}

void PairColumns::assign(const PointColumns& points) {
  resize(static_cast<int>(points.size()));
  std::copy(points.x_m.begin(), points.x_m.end(), x.begin());
  std::copy(points.y_m.begin(), points.y_m.end(), y.begin());
  std::copy(points.z_m.begin(), points.z_m.end(), z.begin());
}

PairAccumulator::PairAccumulator(const Annuli& annuli)
    : rule_(annuli),
      spacing_(annuli.spacing),
      sums_(static_cast<std::size_t>(annuli.count)),
      lanes_(static_cast<std::size_t>(kLanes * 4 * (annuli.count + 1))),
      keys_(kBuffer + kStep),
      values_(4 * (kBuffer + kStep)) {}

void PairAccumulator::add(const PairColumns& points, int i, std::span<const IndexRun> runs) {
  for (IndexRun run : runs)
    while (run.begin < run.end) {
      const int end = std::min(run.end, run.begin + kBuffer - buffered_);
      add_run(points, i, {run.begin, end});
      run.begin = end;
      if (buffered_ == kBuffer) scatter();
    }
}

void PairAccumulator::add_run(const PairColumns& points, int i, IndexRun run) {
  const auto p = static_cast<std::size_t>(i), q = static_cast<std::size_t>(run.begin);
  const auto at = static_cast<std::size_t>(buffered_);
  const auto function = spacing_ == Annuli::Spacing::uniform ? compute_uniform : compute_geometric;
  function(rule_, &points.x[q], &points.y[q], &points.z[q], points.x[p], points.y[p], points.z[p], run.end - run.begin,
           &keys_[at], &values_[4 * at]);
  buffered_ += run.end - run.begin;
}

void PairAccumulator::scatter() {
  const std::ptrdiff_t stride = 4 * (rule_.count + 1);
  const std::int32_t* keys = keys_.data();
  const float* values = values_.data();
  float* lanes = lanes_.data();
  int j = 0;
  for (; j + kLanes <= buffered_; j += kLanes)
    for (int lane = 0; lane < kLanes; ++lane)
      add_row(values + 4 * (j + lane), lanes + lane * stride + 4 * keys[j + lane]);
  for (; j < buffered_; ++j) add_row(values + 4 * j, lanes + 4 * keys[j]);
  pairs_ += static_cast<std::size_t>(buffered_);
  unflushed_ += buffered_;
  buffered_ = 0;
  if (unflushed_ >= kFlush) flush();
}

void PairAccumulator::flush() {
  const auto stride = static_cast<std::size_t>(4 * (rule_.count + 1));
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float* sum = &lanes_[lane * stride + 4 * k];
      sums_[k].count += sum[0];
      sums_[k].abs_m += sum[1];
      sums_[k].square_m2 += sum[2];
      sums_[k].log_m += sum[3];
    }
  }
  std::fill(lanes_.begin(), lanes_.end(), 0.0F);
  unflushed_ = 0;
}

const std::vector<PairSums>& PairAccumulator::sums() {
  scatter();
  flush();
  return sums_;
}

}  // namespace scree::fractal
