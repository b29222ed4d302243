// What `scree reconstruct` reads from its command line: an extent or a temperature, by the first byte.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "fractal/reconstruction/temperature.hpp"
#include "node/reconstruction_grid.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 2 == 0) {
    const auto extent = scree::node::parse_extent(text);
    if (extent && !(extent->x_max_m > extent->x_min_m && extent->y_max_m > extent->y_min_m)) std::abort();
  } else {
    const auto temperature = scree::fractal::parse_temperature(text);
    if (temperature && !(temperature->value_m2 >= 0.0 && std::isfinite(temperature->value_m2))) std::abort();
  }
  return 0;
}
