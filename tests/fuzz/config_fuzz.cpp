// The configuration loader: any text is settings or a list of faults; what is accepted survives a dump and a reload.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "config/loader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto settings = scree::config::parse_settings(text, "fuzz.yaml");
  if (!settings) return settings.error().message.empty() ? (std::abort(), 0) : 0;
  for (const auto& key : settings->publish.keys)
    if (key.file.empty()) return 0;  // a dump does not show it, and so does not load
  const auto dumped = scree::config::dump_settings(*settings);
  const auto again = scree::config::parse_settings(dumped, "dumped.yaml");
  if (!again || scree::config::dump_settings(*again) != dumped) std::abort();
  return 0;
}
