#pragma once
// What `scree reconstruct` says of what it made.

#include <string>
#include <vector>

#include "node/reconstruction_law.hpp"
#include "node/reconstruction_methods.hpp"

namespace scree::node {

struct ReconstructionReport {
  const std::string& method;
  const SurveyInput& input;
  const PlacedSurvey& placed;
  const SurfaceLaw& law;
  const SurfaceAnswer& answer;
  int draws = 0;
  double dimension_of_draw = 0.0;  ///< of draw 0 by axis_dimension; NaN without a draw
};

std::string reconstruction_line(const ReconstructionReport& report);

/// What should be known before the surface is trusted.
std::vector<std::string> reconstruction_remarks(const ReconstructionReport& report);

/// One JSON document. Unknown numbers are null.
std::string reconstruction_json(const ReconstructionReport& report);

}  // namespace scree::node
