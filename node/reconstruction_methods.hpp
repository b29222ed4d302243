#pragma once
// From samples and a law to a surface, by the method that was asked for.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::node {

/// Options that only some methods have; none = the method's default.
struct MethodOptions {
  std::optional<std::string> temperature;     ///< szeliski
  std::optional<int> sweeps;                  ///< szeliski
  std::optional<int> iterations;              ///< polyhedron
  std::optional<std::int64_t> insertions;     ///< barycentre
  std::optional<std::string> barycentre_law;  ///< barycentre: published, exact-variance, conditional, neighbours
  std::optional<std::string> regions;         ///< barycentre: a table of centres, read_regions
};

struct SurfaceAnswer {
  fractal::SurfaceEstimate estimate;
  std::size_t measured_cells = 0;  ///< cells that hold a sample
  double seconds = 0.0;            ///< wall time of the method
};

/// The default first.
std::vector<std::string> reconstruction_methods();

/// Usage where an option does not go with the method, or has a value that it cannot have: said before the work starts.
Status check_method_options(const std::string& method, const MethodOptions& options);

/// `x_min_m`, `y_min_m`: the grid's corner on the map, which the centres of regions are given on. Errors: those of the
/// method; bad_data where the conditional method would need more memory than there is, with the largest size that fits;
/// those of a regions file (CSV: x_m,y_m,dimension,amplitude_m).
Result<SurfaceAnswer> reconstruct_surface(const std::string& method, const fractal::HeightSamples& samples,
                                          const fractal::SurfaceRequest& request, const MethodOptions& options,
                                          double x_min_m, double y_min_m, Executor& executor);

}  // namespace scree::node
