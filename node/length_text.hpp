#pragma once
// Lengths as people write them.

#include <string>

#include "core/result.hpp"

namespace scree::node {

/// Three significant digits, without an exponent from a micrometre to a thousand kilometres: "0.00035", "12.3", "1650".
std::string length_text(double length_m);

/// "0.5 to 20.6 m"
std::string range_text(double low_m, double high_m);

/// Options of metres, 0 = not given. Errors: usage for what is negative or not finite; `meaning` is what was expected.
Status check_length(const char* option, double value, const char* meaning);

}  // namespace scree::node
