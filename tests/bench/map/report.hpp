#pragma once
// Sections of the report on the map; tables and loops over scenes are those of the report on dimension.

#include <string>

#include "tests/bench/dimension/report.hpp"

namespace scree::bench {

/// Folder for the pictures; empty: none are written.
inline std::string pictures;

void ground_section();
void separation_section();

}  // namespace scree::bench
