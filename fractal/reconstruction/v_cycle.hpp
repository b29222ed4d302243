#pragma once
// One multigrid V(1,1) cycle, fused with the conjugate gradients around it.

#include <cstddef>
#include <vector>

#include "fractal/reconstruction/multigrid.hpp"
#include "fractal/reconstruction/operator_rows.hpp"

namespace scree::fractal {

/// The step of conjugate gradients that goes before a cycle: x += α·p, r += α·q with q = −A·p.
struct Advance {
  float alpha = 0.0F;
  const PaddedField *p = nullptr, *q = nullptr;
  PaddedField* x = nullptr;
};

/// Buffers of one solve; cycles with one operator may run side by side. Two passes over each level: down (step of the
/// gradients, smoothing, residual, restriction) and up (prolongation, smoothing, dot product), rows in a pipeline.
class VCycle {
 public:
  void resize(const BlendOperator& matrix);

  /// z ≈ A⁻¹·r, symmetric positive definite; the ghost columns of z are current afterwards. Returns r·z.
  double apply(const BlendOperator& matrix, const PaddedField& r, PaddedField& z);
  /// The same after a step that moves x and r.
  double apply(const BlendOperator& matrix, const Advance& advance, PaddedField& r, PaddedField& z);

 private:
  struct Buffers {
    PaddedField b, z;  // right-hand side and result of a coarser level
  };
  double cycle(const BlendOperator& matrix, std::size_t level, const PaddedField& b, PaddedField& z);
  /// Everything after the first smoothing of rows, which `smooth(row)` does.
  template <class Smooth>
  void down(const BlendOperator& matrix, std::size_t level, const PaddedField& b, PaddedField& z, const Smooth& smooth);
  /// In place: a row is corrected in a ring and written when nobody looks at what it was.
  double up(const BlendOperator& matrix, std::size_t level, const PaddedField& b, PaddedField& z);
  double solve_coarsest(const BlendOperator& matrix, const PaddedField& b, PaddedField& z);
  void restrict_rows(int row, int rows, int stride, PaddedField& coarse);

  std::vector<Buffers> buffers_;
  OperatorRows operator_;
  std::vector<float> ring_, line_;
  std::vector<double> direct_, direct_work_;
};

}  // namespace scree::fractal
