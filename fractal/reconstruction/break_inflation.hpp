#pragma once
// How much less is known near breaks than the law says.

#include "core/grid.hpp"
#include "fractal/reconstruction/line_process.hpp"

namespace scree::fractal {

struct InflationOptions {
  int folds = 4;
  double reach = 0.5;        ///< sd of the window over the spacing of the data
  double prior_count = 0.5;  ///< data that say 1
  double edge_reach = 1.0;   ///< spacings from the nearest broken edge within which it holds
};

/// A factor ≥ 1 of the variance of every cell. Data are left out, a fold at a time, and predicted by a fit whose edges
/// are found anew without them (edges found with a datum make room for it): e²/(v + R), v the variance there without
/// the datum, averages 1 where the law holds. The factor is (n0 + Σ g·e²/(v + R))/(n0 + Σ g) over a window g around the
/// cell; it holds within one spacing of an edge whose factor is below ½, elsewhere it is 1. `fit`: data and the
/// solution with breaks (break_edges); `alone`: v in the fit's unit², at least where measured
/// (SdMap::variance_alone_m2); `hurst`: of the law, for what the folds lack of data. `change`: as for break_edges.
/// Cost: folds · (break_edges + 1 solve).
Grid<float> break_inflation(const BlendFit& fit, const Grid<float>& alone, double hurst, const Grid<float>& change,
                            const LineProcessOptions& lines = {}, const InflationOptions& options = {});

}  // namespace scree::fractal
