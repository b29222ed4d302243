#include "fractal/reconstruction/sd_rows.hpp"

#include <algorithm>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal::sd_rows {

SCREE_CLONES void log_of(const float* __restrict x, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) {
    float log;
    fast_log<float, std::int32_t>(x[i] + 1e-30F, log);
    out[i] = log;
  }
}

SCREE_CLONES void add_scaled(const float* __restrict a, float factor, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] += factor * a[i];
}

SCREE_CLONES void exp_in_place(float* x, int n) {
  for (int i = 0; i < n; ++i) x[i] = fast_exp(std::min(std::max(x[i], -80.0F), 80.0F));
}

SCREE_CLONES void weigh(const std::uint8_t* __restrict measured, float* __restrict weight, int n) {
  for (int i = 0; i < n; ++i) weight[i] = measured[i] != 0 ? 0.0F : 1.0F;
}

/// What the fields say over what the model says, of unmeasured cells.
SCREE_CLONES void ratio_row(const std::uint8_t* __restrict measured, const float* __restrict fields,
                            const float* __restrict model, float* __restrict ratio, int n) {
  for (int i = 0; i < n; ++i) ratio[i] = measured[i] != 0 ? 0.0F : fields[i] / model[i];
}

SCREE_CLONES void correct_row(const float* __restrict ratio, const float* __restrict inside, float row_weight,
                              float mean, float share, float* __restrict model, int n) {
  for (int i = 0; i < n; ++i) model[i] *= mean + share * (ratio[i] / (row_weight * inside[i]) - mean);
}

/// `variance` > 0: of a datum in the cell.
SCREE_CLONES void write_row(const float* __restrict variance, const float* __restrict alone, float* __restrict sd,
                            int n) {
  for (int i = 0; i < n; ++i) {
    const float datum = 1.0F / variance[i];  // or a NaN
    const float inverse = 1.0F / alone[i] + (datum > 0.0F ? datum : 0.0F);
    float log;
    fast_log<float, std::int32_t>(inverse, log);
    sd[i] = fast_exp(-0.5F * log);  // a square root would call for errno and stay scalar
  }
}

}  // namespace scree::fractal::sd_rows
