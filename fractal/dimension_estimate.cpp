#include "fractal/dimension_estimate.hpp"

#include <array>
#include <utility>

namespace scree::fractal {

std::vector<std::string_view> flag_names(std::uint16_t flags) {
  constexpr std::array<std::pair<EstimateFlag, std::string_view>, 6> kNames{{{kNoiseHides, "noise_limited"},
                                                                             {kOpenBelow, "open_below"},
                                                                             {kOpenAbove, "open_above"},
                                                                             {kDuplicatesMerged, "duplicates_merged"},
                                                                             {kHorizontalNoise, "horizontal_noise"},
                                                                             {kScaleDependent, "scale_dependent"}}};
  std::vector<std::string_view> names;
  for (const auto& [flag, name] : kNames)
    if (flags & flag) names.push_back(name);
  return names;
}

}  // namespace scree::fractal
