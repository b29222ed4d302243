#pragma once
// Ground whose D and amplitude vary from place to place, with a known local law.

#include <Eigen/SparseCholesky>
#include <cstdint>
#include <vector>

#include "core/grid.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::bench {

/// Nodes U_i are exact fBm with H spaced by .05, made of one white noise; their *differences* are weighted edge by edge
/// with amplitude times hat weight of H, summed, and the part that is a gradient is integrated (a Poisson equation with
/// no flux through the border). So every zone is fBm of its law, and no amplitude multiplies a height. `law` varies;
/// its amplitudes are rms changes over a cell of size 1. Heights are float, their mean 0.
Grid<float> modulated_truth(const fractal::LawMap& law, std::uint64_t seed);

/// A node and its weight at every cell; that of an edge is the mean of its ends.
struct ModulatedNode {
  double hurst;
  Grid<double> weight;
};
/// Those that weigh anything.
std::vector<ModulatedNode> modulated_nodes(const fractal::LawMap& law);
/// Side of the torus that all nodes share.
int modulated_torus_side(int rows, int columns);

/// Heights of mean 0 on rows × columns cells, L·z = right side less its mean; L the graph Laplacian without flux
/// through the border.
class LatticeIntegrator {
 public:
  LatticeIntegrator(int rows, int columns);
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace scree::bench
