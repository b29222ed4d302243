#pragma once
// Sections of the report on the map; tables and loops over scenes are those of the report on dimension.

#include <string>

#include "tests/bench/dimension/report.hpp"

namespace scree::bench {

/// Folder for the pictures; empty: none are written.
inline std::string pictures;
/// Grounds of each dimension and amplitude.
inline int seeds = 2;
/// Ten thousand frames in the section on memory.
inline bool soak = false;

void ground_section();
void heights_section();
void roughness_section();
void states_section();
void separation_section();
void drift_section();
void speed_section();
void memory_section();
void pictures_section();
void spread_section();

}  // namespace scree::bench
