#pragma once
// The files of `scree reconstruct`.

#include <limits>
#include <string>

#include "core/result.hpp"
#include "fractal/reconstruction/surface_problem.hpp"
#include "node/layer_files.hpp"
#include "node/survey_grid.hpp"

namespace scree::node {

/// BASE.draw0.EXT … as they come, and the rest at the end. Refers to both arguments.
class SurfaceFiles {
 public:
  SurfaceFiles(const LayerFiles& files, const LayerPlace& place) : files_(files), place_(place) {}

  /// For SurfaceRequest::on_draw, which cannot fail: the first failure is kept for finish(), and nothing more written.
  void take_draw(int k, const Grid<float>& draw_m);
  /// BASE.mean, BASE.sd and, where data were left out, BASE.rejected. What an earlier run left under the same name
  /// (draws from `draws` on, rejected) is removed: it must not be taken for this one's. Errors: those of
  /// LayerFiles::write, of the draws too.
  Status finish(const fractal::SurfaceEstimate& estimate, int draws);

  double dimension_of_draw() const { return dimension_; }  ///< of draw 0 by axis_dimension; NaN without one

 private:
  Status write(const std::string& layer, const std::string& title, const Grid<float>& values, bool relief) const;
  void remove_older(int draws) const;

  const LayerFiles& files_;
  const LayerPlace& place_;
  Status status_;
  double dimension_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace scree::node
