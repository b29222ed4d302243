#include "tests/bench/reconstruction/modulated_truth.hpp"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "fractal/fbm_embedding.hpp"
#include "fractal/fourier.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr double kStep = 0.05;
constexpr std::uint64_t kStream = 77;

/// Field of node H, plane included, on one torus for all nodes.
Grid<float> node_field(double hurst, int rows, int columns, std::uint64_t seed) {
  const int side = smooth_even_size(static_cast<int>(std::ceil(4.0 * std::hypot(rows, columns))));
  const FbmEmbedding embedding = make_embedding(hurst, side);
  Grid<float> field = embedded_field(embedding, keyed_white_noise(seed, kStream, side), rows, columns);
  const auto g = random_normals(seed, kStream + 1, 0, 0);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      field(r, c) += static_cast<float>(embedding.plane_slope_sigma() * (g[0] * c + g[1] * r));
  return field;
}

/// Least squares heights of given differences over the edges: L·z = div.
class Integrator {
 public:
  Integrator(int rows, int columns) : rows_(rows), columns_(columns), right_(Eigen::VectorXd::Zero(rows * columns)) {}

  void add(int i, int j, double difference) { right_(j) += difference, right_(i) -= difference; }
  Grid<float> solve() const {
    const int n = rows_ * columns_;
    std::vector<Eigen::Triplet<double>> entries;
    const auto link = [&](int i, int j) {
      for (const auto& [a, b, v] : {std::tuple{i, i, 1.0}, {j, j, 1.0}, {i, j, -1.0}, {j, i, -1.0}})
        entries.emplace_back(a, b, v);
    };
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c) {
        if (c + 1 < columns_) link(r * columns_ + c, r * columns_ + c + 1);
        if (r + 1 < rows_) link(r * columns_ + c, (r + 1) * columns_ + c);
      }
    entries.emplace_back(0, 0, 1.0);  // pins a height: the right side sums to 0
    Eigen::SparseMatrix<double> laplacian(n, n);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(laplacian);
    const Eigen::VectorXd z = factor.solve(right_);
    const double mean = z.mean();
    Grid<float> out(rows_, columns_);
    for (int i = 0; i < n; ++i) out[static_cast<std::size_t>(i)] = static_cast<float>(z(i) - mean);
    return out;
  }

 private:
  int rows_, columns_;
  Eigen::VectorXd right_;
};

}  // namespace

Grid<float> modulated_truth(const LawMap& law, std::uint64_t seed) {
  const int rows = law.dimension.rows(), columns = law.dimension.columns();
  Integrator integrator(rows, columns);
  for (double node = kStep; node < 0.99; node += kStep) {
    const auto weight = [&](int r, int c) {
      const double hurst = 3.0 - static_cast<double>(law.dimension(r, c));
      return static_cast<double>(law.amplitude_m(r, c)) * std::max(0.0, 1.0 - std::abs(hurst - node) / kStep);
    };
    double most = 0.0;
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) most = std::max(most, weight(r, c));
    if (most == 0.0) continue;
    const Grid<float> field = node_field(node, rows, columns, seed);
    const auto edge = [&](int r, int c, int r2, int c2) {
      integrator.add(r * columns + c, r2 * columns + c2,
                     0.5 * (weight(r, c) + weight(r2, c2)) * static_cast<double>(field(r2, c2) - field(r, c)));
    };
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        if (c + 1 < columns) edge(r, c, r, c + 1);
        if (r + 1 < rows) edge(r, c, r + 1, c);
      }
  }
  return integrator.solve();
}

}  // namespace scree::bench
