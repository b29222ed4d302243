#pragma once
// Sections of the report on reconstruction; tables and loops over surfaces are those of the report on dimension.

#include <string>

#include "tests/bench/dimension/report.hpp"

namespace scree::bench {

/// Surfaces that no constant of the conditional method was chosen on.
inline constexpr std::uint64_t kFirstSeed = 7000;

/// Folder for the figures of the sections that have some; empty: none are written.
inline std::string pictures;

void conditional_section();
void varying_section();
void oracle_section();
void holes_section();
void calibration_section();
void large_section();
void delaunay_section();
void polyhedron_section();
void barycentre_section();
void combined_section();
void fbm_section();
void sd_section();
void outliers_section();
void cliffs_section();
void occlusion_section();
void robust_varying_section();
void methods_section();
void kriging_section();
void sampler_section();
void paper_tables_section();
void peers_section();

}  // namespace scree::bench
