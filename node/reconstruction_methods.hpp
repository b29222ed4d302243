#pragma once
// From samples and a law to a surface, by the method that was asked for.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "node/reconstruction_grid.hpp"

namespace scree::node {

/// Options that only some methods have; none = the method's default.
struct MethodOptions {
  std::optional<std::string> temperature;  ///< szeliski
  std::optional<int> sweeps;               ///< szeliski
  std::optional<int> iterations;           ///< polyhedron
  std::optional<std::int64_t> insertions;  ///< barycentre
  std::optional<std::string>
      barycentre_law;                  ///< barycentre: published, exact-variance, conditional, neighbours, corrected
  std::optional<std::string> regions;  ///< barycentre: a table of centres (CSV: x_m,y_m,dimension,amplitude_m)
  std::optional<int> fields;           ///< conditional: residual fields behind the sd
  bool keep_outliers = false;          ///< conditional: no gate
  bool breaks = false;                 ///< conditional: line process
  std::optional<std::string> ceiling;  ///< conditional: a raster of rays' heights
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

/// Errors: those of the method; bad_data where the conditional method would need more memory than there is, with the
/// largest size that fits; those of the files that options name.
Result<SurfaceAnswer> reconstruct_surface(const std::string& method, const PlacedSurvey& placed,
                                          const fractal::SurfaceRequest& request, const MethodOptions& options,
                                          Executor& executor);

}  // namespace scree::node
