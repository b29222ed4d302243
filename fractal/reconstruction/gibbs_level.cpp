#include "fractal/reconstruction/gibbs_level.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

struct Stencil {
  float centre, side, diagonal, far;
  explicit Stencil(BlendWeights w)
      : centre(4.0F * w.w1 + 20.0F * w.w2), side(-w.w1 - 8.0F * w.w2), diagonal(2.0F * w.w2), far(w.w2) {}
};

/// Half-sample reflection, as often as it takes.
int reflected(int i, int n) {
  const int period = 2 * n, m = ((i % period) + period) % period;
  return m < n ? m : period - 1 - m;
}

/// Places of the neighbours at offsets −2 … 2.
std::array<int, 5> around(int i, int n) {
  return {reflected(i - 2, n), reflected(i - 1, n), i, reflected(i + 1, n), reflected(i + 2, n)};
}

float stencil_weight(const Stencil& a, int dy, int dx) {
  switch (dy * dy + dx * dx) {
    case 0:
      return a.centre;
    case 1:
      return a.side;
    case 2:
      return a.diagonal;
    default:
      return dy == 0 || dx == 0 ? a.far : 0.0F;  // 4, and 5 and 8, which are not part of it
  }
}

/// What the whole stencil gives at column c but for its centre's data; `rows` the five rows around.
float apply(const Stencil& a, const std::array<const float*, 5>& rows, const std::array<int, 5>& c) {
  const auto [c0, c1, c2, c3, c4] = c;
  const float sides = (rows[2][c1] + rows[2][c3]) + (rows[1][c2] + rows[3][c2]);
  const float diagonals = (rows[1][c1] + rows[1][c3]) + (rows[3][c1] + rows[3][c3]);
  const float fars = (rows[2][c0] + rows[2][c4]) + (rows[0][c2] + rows[4][c2]);
  return a.centre * rows[2][c2] + a.side * sides + a.diagonal * diagonals + a.far * fars;
}

}  // namespace

void GibbsLevel::finish() {
  const Stencil stencil(weights);
  variance.assign(rows(), columns(), 0.0F);
  for (int r = 0; r < rows(); ++r)
    for (int c = 0; c < columns(); ++c) {
      const auto ys = around(r, rows()), xs = around(c, columns());
      float own = 0.0F;  // reflected neighbours of a border cell may be the cell itself
      for (std::size_t y = 0; y < ys.size(); ++y)
        for (std::size_t x = 0; x < xs.size(); ++x)
          if (ys[y] == r && xs[x] == c)
            own += stencil_weight(stencil, static_cast<int>(y) - 2, static_cast<int>(x) - 2);
      const float total = own + precision(r, c);
      variance(r, c) = total > 0.0F ? 1.0F / total : 0.0F;  // a single cell without data stays where it is
    }
}

void normals_row(const SweepNoise& noise, int row, int count, float* out) {
  constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
  for (int c = 0; c < count; c += 4) {
    const auto words = random_words(noise.seed, noise.stream, c / 4, row);
    std::array<float, 4> four;
    for (std::size_t p = 0; p < 4; p += 2) {
      const float radius = std::sqrt(-2.0F * std::log((static_cast<float>(words[p] >> 8) + 0.5F) * 0x1p-24F));
      const float angle = kTurn * (static_cast<float>(words[p + 1] >> 8) * 0x1p-24F);
      four[p] = radius * std::cos(angle);
      four[p + 1] = radius * std::sin(angle);
    }
    for (int i = 0; i < 4 && c + i < count; ++i) out[c + i] = four[static_cast<std::size_t>(i)];
  }
}

void gibbs_sweep(const GibbsLevel& level, const SweepNoise* noise, Grid<float>& x) {
  const Stencil stencil(level.weights);
  const int rows = level.rows(), columns = level.columns();
  std::vector<float> normals(static_cast<std::size_t>(columns), 0.0F);
  for (int r = 0; r < rows; ++r) {
    std::array<const float*, 5> near;
    const auto ys = around(r, rows);
    for (std::size_t k = 0; k < 5; ++k) near[k] = x.row(ys[k]).data();
    if (noise != nullptr) normals_row(*noise, r, columns, normals.data());
    const float *precision = level.precision.row(r).data(), *right = level.right.row(r).data();
    const float* variance = level.variance.row(r).data();
    float* line = x.row(r).data();
    const auto update = [&](int c, const std::array<int, 5>& xs) {
      const float pull = right[c] - (apply(stencil, near, xs) + precision[c] * line[c]);
      line[c] += variance[c] * pull;
      if (noise != nullptr) line[c] += std::sqrt(variance[c]) * normals[static_cast<std::size_t>(c)];
    };
    int c = 0;
    for (; c < std::min(2, columns); ++c) update(c, around(c, columns));
    for (; c < columns - 2; ++c) update(c, {c - 2, c - 1, c, c + 1, c + 2});
    for (; c < columns; ++c) update(c, around(c, columns));
  }
}

}  // namespace scree::fractal
