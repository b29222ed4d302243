#include "tests/bench/reconstruction/modulated_covariance.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>

#include "fractal/fbm_embedding.hpp"
#include "tests/bench/dimension/report.hpp"
#include "tests/bench/reconstruction/padded_transform.hpp"

namespace scree::bench {
namespace {

using namespace fractal;
using Complex = std::complex<double>;
using Plane = PaddedTransform::Plane;

constexpr int kPairs = 16;  // of unit vectors, one work space

/// Cosine sums of a sequence that is even on a torus of `side`, given on 0 … side/2: from `lags` frequencies up.
Eigen::MatrixXd cosines(int side, Eigen::Index wanted) {
  Eigen::MatrixXd m(wanted, side / 2 + 1);
  for (Eigen::Index k = 0; k < m.rows(); ++k)
    for (Eigen::Index j = 0; j < m.cols(); ++j)
      m(k, j) = (j == 0 || j == side / 2 ? 1.0 : 2.0) *
                std::cos(2.0 * std::numbers::pi * static_cast<double>(k * j % side) / side);
  return m;
}

/// Spectra of the nodes' covariances on the torus of the transform: rows 0 … side/2, whole columns.
class NodeKernels {
 public:
  NodeKernels(const std::vector<ModulatedNode>& nodes, int n, int side) : nodes_(nodes.size()), side_(side) {
    const int torus = modulated_torus_side(n, n);
    std::vector<FbmEmbedding> embeddings;
    for (const ModulatedNode& node : nodes) embeddings.push_back(make_embedding(node.hurst, torus));
    const Eigen::MatrixXd to_lags = cosines(torus, side / 2 + 1), to_spectrum = cosines(side, side / 2 + 1);
    kernels_.resize(nodes_ * nodes_);
    for (std::size_t i = 0; i < nodes_; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        const Eigen::MatrixXd lags = covariance(embeddings[i], embeddings[j], to_lags);
        const Eigen::MatrixXd spectrum = to_spectrum * lags * to_spectrum.transpose();
        Eigen::MatrixXd whole(side, side / 2 + 1);
        for (int u = 0; u < side; ++u) whole.row(u) = spectrum.row(std::min(u, side - u));
        kernels_[i * nodes_ + j] = kernels_[j * nodes_ + i] = std::move(whole);
      }
  }
  /// `side` values of row u.
  const double* row(std::size_t i, std::size_t j, int u) const {
    return kernels_[i * nodes_ + j].col(std::min(u, side_ - u)).data();
  }

 private:
  /// By lag, of the increments: with the planes' −½·s_i·s_j·r².
  static Eigen::MatrixXd covariance(const FbmEmbedding& a, const FbmEmbedding& b, const Eigen::MatrixXd& to_lags) {
    const Eigen::Index half = to_lags.cols();
    Eigen::MatrixXd spectrum(half, half);
    for (Eigen::Index k = 0; k < spectrum.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      spectrum(k) = std::sqrt(std::max(a.eigenvalues[at], 0.0) * std::max(b.eigenvalues[at], 0.0));
    }
    const double scale = 0.5 * std::pow(a.unit_cells, a.hurst) * std::pow(b.unit_cells, b.hurst) / a.side / a.side;
    Eigen::MatrixXd lags = scale * (to_lags * spectrum * to_lags.transpose());
    const double planes = a.plane_slope_sigma() * b.plane_slope_sigma();
    for (Eigen::Index y = 0; y < lags.rows(); ++y)
      for (Eigen::Index x = 0; x < lags.cols(); ++x) lags(y, x) -= 0.5 * planes * static_cast<double>(x * x + y * y);
    return lags;
  }

  std::size_t nodes_;
  int side_;
  std::vector<Eigen::MatrixXd> kernels_;
};

/// G'·W·G·y.
void add_weighted_laplacian(const Grid<double>& weight, const Plane& y, Plane& out) {
  const int n = weight.rows();
  const auto edge = [&](std::size_t p, std::size_t q) {
    const Complex flux = 0.5 * (weight[p] + weight[q]) * (y[q] - y[p]);
    out[q] += flux;
    out[p] -= flux;
  };
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) {
      const auto p = static_cast<std::size_t>(r * n + c);
      if (c + 1 < n) edge(p, p + 1);
      if (r + 1 < n) edge(p, p + static_cast<std::size_t>(n));
    }
}

class Application {
 public:
  Application(const std::vector<ModulatedNode>& nodes, const NodeKernels& kernels, const LatticeIntegrator& integrator,
              int n)
      : nodes_(nodes), kernels_(kernels), integrator_(integrator), n_(n), transform_(n) {
    const auto torus = static_cast<std::size_t>(transform_.side()) * static_cast<std::size_t>(transform_.side());
    spectra_.assign(nodes.size(), Plane(torus));
    mixed_.resize(torus);
    field_.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  }

  /// Columns of C for two cells: real and imaginary part.
  Plane columns(std::size_t one, std::size_t other) {
    Plane y(field_.size());
    y[one] += 1.0;
    y[other] += Complex(0.0, 1.0);
    y = integrated(y);
    for (std::size_t j = 0; j < nodes_.size(); ++j) {
      std::fill(field_.begin(), field_.end(), Complex());
      add_weighted_laplacian(nodes_[j].weight, y, field_);
      transform_.forward(field_, spectra_[j]);
    }
    Plane sum(field_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      mix(i);
      transform_.backward(mixed_, field_);
      add_weighted_laplacian(nodes_[i].weight, field_, sum);
    }
    return integrated(sum);
  }

 private:
  void mix(std::size_t i) {
    const int side = transform_.side();
    std::fill(mixed_.begin(), mixed_.end(), Complex());
    for (int u = 0; u < side; ++u) {
      Complex* out = &mixed_[static_cast<std::size_t>(u * side)];
      for (std::size_t j = 0; j < nodes_.size(); ++j) {
        const double* kernel = kernels_.row(i, j, u);
        const Complex* in = &spectra_[j][static_cast<std::size_t>(u * side)];
        for (int v = 0; v < side; ++v) out[v] += kernel[v] * in[v];
      }
    }
  }
  Plane integrated(const Plane& right) const {
    Eigen::VectorXd real(n_ * n_), imaginary(n_ * n_);
    for (Eigen::Index i = 0; i < real.size(); ++i) {
      real(i) = right[static_cast<std::size_t>(i)].real();
      imaginary(i) = right[static_cast<std::size_t>(i)].imag();
    }
    real = integrator_.solve(real);
    imaginary = integrator_.solve(imaginary);
    Plane out(right.size());
    for (Eigen::Index i = 0; i < real.size(); ++i) out[static_cast<std::size_t>(i)] = {real(i), imaginary(i)};
    return out;
  }

  const std::vector<ModulatedNode>& nodes_;
  const NodeKernels& kernels_;
  const LatticeIntegrator& integrator_;
  int n_;
  PaddedTransform transform_;
  std::vector<Plane> spectra_;
  Plane mixed_, field_;
};

}  // namespace

ModulatedCovariance::ModulatedCovariance(const LawMap& law) : side_(law.dimension.rows()) {
  const int n = side_, count = n * n / 2;
  assert(law.dimension.columns() == n && n % 2 == 0);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c)
      assert(law.dimension(r, c) == law.dimension(n - 1 - r, c) &&
             law.amplitude_m(r, c) == law.amplitude_m(n - 1 - r, c));
  std::vector<ModulatedNode> nodes = modulated_nodes(law);
  std::erase_if(nodes, [](const ModulatedNode& node) {  // D in float leaves crumbs
    return *std::max_element(node.weight.begin(), node.weight.end()) < 1e-5;
  });
  const NodeKernels kernels(nodes, n, smooth_even_size(2 * n));
  const LatticeIntegrator integrator(n, n);
  columns_.resize(n * n, count);
  over_surfaces((count + 2 * kPairs - 1) / (2 * kPairs), [&](int chunk) {
    Application application(nodes, kernels, integrator, n);
    const int first = chunk * 2 * kPairs;
    for (int q = first; q < std::min(first + 2 * kPairs, count); q += 2) {
      const Plane pair = application.columns(static_cast<std::size_t>(q), static_cast<std::size_t>(q + 1));
      for (Eigen::Index p = 0; p < columns_.rows(); ++p) {
        columns_(p, q) = pair[static_cast<std::size_t>(p)].real();
        columns_(p, q + 1) = pair[static_cast<std::size_t>(p)].imag();
      }
    }
    return 0;
  });
}

}  // namespace scree::bench
