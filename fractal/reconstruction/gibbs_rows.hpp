#pragma once
// The sampler of gibbs_level.hpp with rows as vectors.

#include <cstdint>
#include <vector>

#include "fractal/reconstruction/gibbs_level.hpp"

namespace scree::fractal {

/// A field with its columns dealt out to three arrays a row, c = 3j + phase: cells of one phase do not see each other
/// through the 13-point stencil, so a row is three vector updates. Two ghost columns on either side.
class PhaseField {
 public:
  void resize(int rows, int columns);
  void load(const Grid<float>& values);
  void store(Grid<float>& values) const;
  int rows() const { return rows_; }
  int columns() const { return columns_; }
  /// Cells of a phase.
  int count(int phase) const { return (columns_ - phase + 2) / 3; }
  float* phase(int row, int p) { return cells_.data() + offset(row, p); }
  const float* phase(int row, int p) const { return cells_.data() + offset(row, p); }
  /// The ghost columns of a row by half-sample reflection.
  void reflect(int row);

 private:
  float& at(int row, int c) { return phase(row, (c + 3) % 3)[(c + 3) / 3 - 1]; }
  std::ptrdiff_t offset(int row, int p) const { return (static_cast<std::ptrdiff_t>(row) * 3 + p) * width_ + 1; }
  int rows_ = 0, columns_ = 0, width_ = 0;
  std::vector<float> cells_;
};

/// The same conditional distributions as gibbs_sweep() in another order of cells (row by row, in a row phase by phase),
/// with normals from normal_block(): other random numbers, the same law. For comparisons of speed with a sampler that
/// nobody can call slow.
class GibbsRows {
 public:
  /// Keeps what it needs of `level`; right-hand side included.
  explicit GibbsRows(const GibbsLevel& level);

  /// As gibbs_sweep().
  void sweep(const SweepNoise* noise, PhaseField& x);

 private:
  BlendWeights weights_;
  PhaseField precision_, right_, variance_, deviation_;
  std::vector<float> normals_;
};

}  // namespace scree::fractal
