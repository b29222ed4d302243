#pragma once
// What `scree dimension` says: one line for people, one JSON document for programs.

#include <optional>
#include <string>
#include <vector>

#include "fractal/anisotropy.hpp"
#include "node/dimension_maps.hpp"
#include "node/dimension_methods.hpp"
#include "node/survey_input.hpp"

namespace scree::node {

/// Everything that was found about one input.
struct DimensionReport {
  const SurveyInput& input;
  const DimensionRequest& request;
  const DimensionAnswer& answer;
  std::optional<fractal::Anisotropy> anisotropy;
  std::optional<MapsSummary> maps;
};

/// Those of the answer, and anisotropic.
std::vector<std::string> all_flags(const DimensionReport& report);

/// Ends with the flags by name.
std::string dimension_line(const DimensionReport& report);

/// A sentence on each flag that changes what D means.
std::vector<std::string> dimension_remarks(const DimensionReport& report);

/// Keys and units: README.md. Unknown numbers are null.
std::string dimension_json(const DimensionReport& report);

}  // namespace scree::node
