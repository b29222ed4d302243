#pragma once
// Lengths as people write them.

#include <string>

namespace scree::node {

/// Three significant digits, without an exponent from a micrometre to a thousand kilometres: "0.00035", "12.3", "1650".
std::string length_text(double length_m);

/// "0.5 to 20.6 m"
std::string range_text(double low_m, double high_m);

}  // namespace scree::node
