#pragma once
// Sections of the report on reconstruction; tables and loops over surfaces are those of the report on dimension.

#include "tests/bench/dimension/report.hpp"

namespace scree::bench {

void conditional_section();
void delaunay_section();
void polyhedron_section();
void peers_section();
void barycentre_section();
void methods_section();
void kriging_section();

}  // namespace scree::bench
