#pragma once
// Statistics of height differences over pairs of points, in annuli of distance: the counters of [AK96] section 2.4.

#include <cstdint>
#include <vector>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::fractal {

/// Scattered heights, one column a coordinate, all of one length; float32 metres relative to an origin near the data
/// (take large offsets off in double before).
struct PointColumns {
  std::vector<float> x_m, y_m, z_m;
  std::size_t size() const { return z_m.size(); }
  void reserve(std::size_t count);
  void push_back(float x, float y, float z);
};

/// Annuli i = 0 … count−1 around distances d_i; a pair belongs to annulus i when its distance is within `half_width` of
/// d_i. They do not overlap, so a pair counts at most once. The rule is evaluated in float32 by every route alike
/// (annulus_rule.hpp): routes agree to the pair, and only pairs within a few ulp of a border may be put elsewhere by
/// exact arithmetic.
struct Annuli {
  enum class Spacing {
    uniform,    ///< d_i = first_m + i·step, |d − d_i| < half_width; step, half_width in metres
    geometric,  ///< d_i = first_m·step^i, |ln d − ln d_i| < half_width; step a ratio, half_width in nepers
  };
  Spacing spacing = Spacing::uniform;
  double first_m = 1.0;
  double step = 1.0;
  int count = 0;
  double half_width = 0.5;

  double distance_m(int i) const;
  double inner_m(int i) const;  ///< borders of annulus i
  double outer_m(int i) const;
};

/// The paper's annuli: step, 2·step … up to `last_m`, touching each other (ε = step/2).
Annuli uniform_annuli(double step_m, double last_m);
/// first_m, first_m·ratio … up to `last_m`, touching each other.
Annuli geometric_annuli(double first_m, double ratio, double last_m);

/// Sums over the pairs of one annulus, each unordered pair once.
struct PairSums {
  double count = 0.0;      ///< C: a whole number
  double abs_m = 0.0;      ///< A: Σ |z − z'|
  double square_m2 = 0.0;  ///< B: Σ (z − z')²
  double log_m = 0.0;      ///< Σ ln(distance / 1 m)
};

struct StructureFunction {
  Annuli annuli;
  std::vector<PairSums> sums;     ///< one an annulus
  bool has_absolute = true;       ///< false: the route cannot sum |z − z'| (Fourier), abs_m is NaN
  std::size_t pairs_visited = 0;  ///< distances computed (0 for Fourier): the work done
};

enum class PairRoute {
  reference,   ///< every pair, one at a time, in double: O(N²), the oracle
  all_pairs,   ///< every pair, vectorised: O(N²)
  near_pairs,  ///< every pair up to the outermost border, through a cell list: O(N·points within it)
  thinned,  ///< distances in [2^o, 2^(o+1)) spacings on a random 4^(−o)th of the points: O(N), a sample of the pairs
  lattice,  ///< points moved to the centres of cells of one spacing, then FFTs: O(N log N); exact for lattice data
};

struct PairOptions {
  PairRoute route = PairRoute::near_pairs;
  /// thinned: the unit of the octaves; lattice: the cell. 0 = √(area of the bounding box / N).
  double spacing_m = 0.0;
  double thinning_density = 2.0;  ///< thinned: keeps min(1, density·4^(−o)) of the points at octave o
  std::uint64_t seed = 1;         ///< thinned: which points
};

/// Deterministic: independent of the executor's threads and of the CPU. Validity: 2 ≤ N < 2^31, finite coordinates.
/// Errors: usage (annuli that overlap or are not positive, options), bad_data (columns of different lengths, fewer than
/// 2 points, non-finite values, a lattice of more than 2^26 cells). Costs: docs/fractal.md. Source: [AK96].
Result<StructureFunction> structure_function(const PointColumns& points, const Annuli& annuli,
                                             const PairOptions& options, Executor& executor);

/// All pairs of known cells (NaN = unknown) of a lattice by the autocorrelation of its mask [M96]: exact up to rounding
/// (1e-10 of the sums). No Σ|z − z'|. Errors: as above. Cost: O(M log M), M = cells padded by the outermost border.
Result<StructureFunction> lattice_structure_function(const Grid<float>& height_m, double cell_m, const Annuli& annuli,
                                                     Executor& executor);

}  // namespace scree::fractal
