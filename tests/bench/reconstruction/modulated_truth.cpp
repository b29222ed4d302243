#include "tests/bench/reconstruction/modulated_truth.hpp"

#include <Eigen/Sparse>
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
  const int side = modulated_torus_side(rows, columns);
  const FbmEmbedding embedding = make_embedding(hurst, side);
  Grid<float> field = embedded_field(embedding, keyed_white_noise(seed, kStream, side), rows, columns);
  const auto g = random_normals(seed, kStream + 1, 0, 0);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      field(r, c) += static_cast<float>(embedding.plane_slope_sigma() * (g[0] * c + g[1] * r));
  return field;
}

}  // namespace

int modulated_torus_side(int rows, int columns) {
  return smooth_even_size(static_cast<int>(std::ceil(4.0 * std::hypot(rows, columns))));
}

std::vector<ModulatedNode> modulated_nodes(const LawMap& law) {
  std::vector<ModulatedNode> nodes;
  for (double hurst = kStep; hurst < 0.99; hurst += kStep) {
    ModulatedNode node{hurst, Grid<double>(law.dimension.rows(), law.dimension.columns())};
    for (std::size_t i = 0; i < node.weight.size(); ++i)
      node.weight[i] = static_cast<double>(law.amplitude_m[i]) *
                       std::max(0.0, 1.0 - std::abs(3.0 - static_cast<double>(law.dimension[i]) - hurst) / kStep);
    if (*std::max_element(node.weight.begin(), node.weight.end()) > 0.0) nodes.push_back(std::move(node));
  }
  return nodes;
}

LatticeIntegrator::LatticeIntegrator(int rows, int columns) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto link = [&](int i, int j) {
    for (const auto& [a, b, v] : {std::tuple{i, i, 1.0}, {j, j, 1.0}, {i, j, -1.0}, {j, i, -1.0}})
      entries.emplace_back(a, b, v);
  };
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      if (c + 1 < columns) link(r * columns + c, r * columns + c + 1);
      if (r + 1 < rows) link(r * columns + c, (r + 1) * columns + c);
    }
  entries.emplace_back(0, 0, 1.0);  // pins a height: the right side sums to 0
  Eigen::SparseMatrix<double> laplacian(rows * columns, rows * columns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(laplacian);
}

Eigen::VectorXd LatticeIntegrator::solve(const Eigen::VectorXd& right) const {
  const Eigen::VectorXd z = factor_.solve((right.array() - right.mean()).matrix());
  return z.array() - z.mean();
}

Grid<float> modulated_truth(const LawMap& law, std::uint64_t seed) {
  const int rows = law.dimension.rows(), columns = law.dimension.columns();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(rows * columns);
  for (const ModulatedNode& node : modulated_nodes(law)) {
    const Grid<float> field = node_field(node.hurst, rows, columns, seed);
    const auto edge = [&](int r, int c, int r2, int c2) {
      const double change =
          0.5 * (node.weight(r, c) + node.weight(r2, c2)) * static_cast<double>(field(r2, c2) - field(r, c));
      right(r2 * columns + c2) += change;
      right(r * columns + c) -= change;
    };
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        if (c + 1 < columns) edge(r, c, r, c + 1);
        if (r + 1 < rows) edge(r, c, r + 1, c);
      }
  }
  const Eigen::VectorXd z = LatticeIntegrator(rows, columns).solve(right);
  Grid<float> out(rows, columns);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<float>(z(static_cast<Eigen::Index>(i)));
  return out;
}

}  // namespace scree::bench
