#include "fractal/reconstruction/line_process.hpp"

#include <algorithm>

namespace scree::fractal {
namespace {

constexpr int kMaxIterations = 100;

/// Factors of the edges between the rows' cells a[i] and b[i].
void weigh_row(const float* a, const float* b, const float* change, float tau, float least, float* e, int n) {
  for (int i = 0; i < n; ++i) {
    const float step = (b[i] - a[i]) / (tau * (change != nullptr ? change[i] : 1.0F));
    const float root = 1.0F / (1.0F + step * step);
    e[i] = std::max(least, root * root);
  }
}

}  // namespace

void break_edges(BlendFit& fit, const Grid<float>& change, const LineProcessOptions& options) {
  const int rows = fit.shape().rows, columns = fit.shape().columns;
  BlendField& prior = fit.prior();
  prior.right.reshape(rows, columns);
  prior.down.reshape(rows, columns);
  for (const double tau : options.steps) {
    for (int r = 0; r < rows; ++r) {
      const float *here = fit.row(r), *below = fit.row(std::min(r + 1, rows - 1));
      const float* unit = r < change.rows() ? change.row(r).data() : nullptr;
      const int inside = change.empty() ? columns - 1 : std::min(columns - 1, change.columns());
      const auto t = static_cast<float>(tau), least = static_cast<float>(options.least);
      std::fill_n(prior.right.row(r), columns, 1.0F);
      std::fill_n(prior.down.row(r), columns, 1.0F);
      if (!change.empty() && unit == nullptr) continue;  // beyond the map there are no data and no breaks
      weigh_row(here, here + 1, unit, t, least, prior.right.row(r), inside);
      weigh_row(here, below, unit, t, least, prior.down.row(r), std::min(inside + 1, columns));
    }
    fit.solve(options.tolerance, kMaxIterations);
  }
}

}  // namespace scree::fractal
