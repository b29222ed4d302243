#include "node/reconstruction_outputs.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <system_error>

#include "fractal/axis_dimension.hpp"

namespace scree::node {

void SurfaceFiles::take_draw(int k, const Grid<float>& draw_m) {
  if (k == 0) dimension_ = fractal::axis_dimension(draw_m);
  if (status_) status_ = write(fmt::format("draw{}", k), fmt::format("draw {} / m", k), draw_m, true);
}

Status SurfaceFiles::finish(const fractal::SurfaceEstimate& estimate, int draws) {
  if (!status_) return status_;
  remove_older(draws);
  if (Status status = write("mean", "mean / m", estimate.mean_m, true); !status) return status;
  if (Status status = write("sd", "standard deviation / m", estimate.sd_m, false); !status) return status;
  if (estimate.rejected_cells == 0) return {};
  Grid<float> rejected(estimate.rejected.rows(), estimate.rejected.columns());
  std::copy(estimate.rejected.begin(), estimate.rejected.end(), rejected.begin());
  return write("rejected", "left out (1)", rejected, false);
}

Status SurfaceFiles::write(const std::string& layer, const std::string& title, const Grid<float>& values,
                           bool relief) const {
  const io::ColourScale scale{relief ? io::ColourMap::terrain : io::ColourMap::viridis, {}, {}, relief};
  return files_.write(layer, {title, values, scale}, place_.raster, place_.picture);
}

void SurfaceFiles::remove_older(int draws) const {
  std::error_code ignored;
  std::filesystem::remove(files_.file("rejected"), ignored);
  for (int k = draws; std::filesystem::remove(files_.file(fmt::format("draw{}", k)), ignored); ++k) {
  }
}

}  // namespace scree::node
