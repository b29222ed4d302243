#pragma once
// What `scree dimension` says: one line for people, one JSON document for programs.

#include <optional>
#include <string>

#include "node/dimension_maps.hpp"
#include "node/dimension_methods.hpp"
#include "node/survey_input.hpp"

namespace scree::node {

/// Everything that was found about one input.
struct DimensionReport {
  const SurveyInput& input;
  const DimensionRequest& request;
  const DimensionAnswer& answer;
  std::optional<MapsSummary> maps;
};

std::string dimension_line(const DimensionReport& report);
std::string dimension_json(const DimensionReport& report);

}  // namespace scree::node
