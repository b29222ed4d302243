#include "fractal/reconstruction/surface_checks.hpp"

#include <cmath>
#include <fmt/format.h>

namespace scree::fractal {
namespace {

template <class... Args>
Error usage(fmt::format_string<Args...> text, Args&&... args) {
  return {ErrorKind::usage, fmt::format(text, std::forward<Args>(args)...)};
}

Status check_request(std::string_view method, const SurfaceRequest& request) {
  const FractalLaw& law = request.law.law;
  if (!(law.dimension > 2.0 && law.dimension < 3.0))
    return usage("{}: expected 2 < D < 3, found D = {}", method, law.dimension);
  if (!(law.amplitude_m > 0.0 && std::isfinite(law.amplitude_m)))
    return usage("{}: expected a finite amplitude > 0 m, found {}", method, law.amplitude_m);
  const SurfaceGrid& grid = request.grid;
  if (!(grid.cell_m > 0.0 && std::isfinite(grid.cell_m)))
    return usage("{}: expected a finite cell > 0 m, found {}", method, grid.cell_m);
  if (grid.rows < 1 || grid.columns < 1)
    return usage("{}: expected at least 1 x 1 cells, found {} x {}", method, grid.rows, grid.columns);
  if (request.draws < 0) return usage("{}: expected at least 0 draws, found {}", method, request.draws);
  return {};
}

}  // namespace

Status check_surface(std::string_view method, const CellSamples& samples, const SurfaceRequest& request,
                     std::size_t at_least) {
  if (Status status = check_request(method, request); !status) return status;
  const auto [rows, columns] = std::pair{request.grid.rows, request.grid.columns};
  if (samples.height_m.rows() != rows || samples.height_m.columns() != columns || samples.variance_m2.rows() != rows ||
      samples.variance_m2.columns() != columns)
    return usage("{}: expected samples on {} x {} cells, found {} x {}", method, rows, columns, samples.height_m.rows(),
                 samples.height_m.columns());
  std::size_t measured = 0;
  for (std::size_t i = 0; i < samples.height_m.size(); ++i) {
    const float height = samples.height_m[i], variance = samples.variance_m2[i];
    if (std::isnan(height)) continue;
    ++measured;
    if (!std::isfinite(height) || !(variance > 0.0F))
      return Error{
          ErrorKind::bad_data,
          fmt::format("{}: expected a finite height and a variance > 0 in cell ({}, {}), found {} m and {} m2", method,
                      i / static_cast<std::size_t>(columns), i % static_cast<std::size_t>(columns), height, variance)};
  }
  if (measured < at_least)
    return Error{ErrorKind::bad_data, fmt::format("{}: expected at least {} measured cell{} in {} x {}, found {}",
                                                  method, at_least, at_least == 1 ? "" : "s", rows, columns, measured)};
  return {};
}

Status check_one_law(std::string_view method, const LawMap& law) {
  if (!law.varies()) return {};
  return usage(
      "{}: expected one D and one amplitude for the whole map, found rasters of them; the conditional method "
      "takes those",
      method);
}

}  // namespace scree::fractal
