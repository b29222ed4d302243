#pragma once
// The law and the noise that a reconstruction goes by: given, from files, or found in the survey.

#include <cstdint>
#include <optional>
#include <string>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "node/dimension_methods.hpp"
#include "node/reconstruction_grid.hpp"

namespace scree::node {

/// As on the command line: a number, "auto", or the name of a raster (dimension and amplitude).
struct LawRequest {
  std::string dimension = "auto";
  std::string amplitude = "auto";
  std::string noise = "auto";
  std::uint64_t seed = 1;
};

enum class NoiseSource : std::uint8_t {
  given,
  repeated,  ///< pooled variance of heights at one place
  sensor,    ///< of a recording: the sensor's own model
  assumed,   ///< 0.01 of the rms height change over a cell
};

struct SurfaceLaw {
  fractal::LawMap map;
  double noise_sigma_m = 0.0;
  NoiseSource noise_source = NoiseSource::given;
  std::optional<DimensionAnswer> found;  ///< where D was to be estimated
  std::size_t repeats = 0;               ///< heights beyond the first at one place
  double repeat_sigma_m = 0.0;           ///< their pooled standard deviation
  bool contradictory = false;            ///< more than noise_sigma_m allows (χ², 4 standard deviations and 6)
};

/// Heights at one place, at least kRepeats beyond the first, tell the noise where none is given.
inline constexpr std::size_t kRepeats = 10;

/// D `auto`: find_dimension of the survey. Amplitude `auto` beside a given D: the likelihood's at that D. A file is
/// looked up at the centres of the grid's cells and must have a value for every one. Errors: usage (numbers out of
/// range, a raster of D without an amplitude), bad_data (a survey that does not tell, with the option to give instead;
/// a raster that does not cover the grid or has a value out of range), those of the readers.
Result<SurfaceLaw> resolve_law(const SurveyInput& survey, const PlacedSurvey& placed, const LawRequest& request,
                               Executor& executor);

/// "given", "repeated samples", …
std::string noise_source_text(NoiseSource source);

}  // namespace scree::node
