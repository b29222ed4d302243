#include "node/length_text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace scree::node {

std::string length_text(double length_m) {
  if (!std::isfinite(length_m)) return "?";
  const double size = std::abs(length_m);
  if (size >= 1e6 || (size < 1e-6 && size > 0.0)) return fmt::format("{:.3g}", length_m);
  const int before = size > 0.0 ? static_cast<int>(std::floor(std::log10(size))) : 0;
  std::string text = fmt::format("{:.{}f}", length_m, std::max(0, 2 - before));
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string range_text(double low_m, double high_m) {
  return length_text(low_m) + " to " + length_text(high_m) + " m";
}

Status check_length(const char* option, double value, const char* meaning) {
  if (value >= 0.0 && std::isfinite(value)) return {};
  return Error{ErrorKind::usage, fmt::format("{}: expected {}, found {}", option, meaning, value)};
}

}  // namespace scree::node
