// recording.yaml: any text is a description or a list of faults; what is accepted survives writing and reading.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "config/recording_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto recording = scree::config::parse_recording(text, "fuzz.yaml");
  if (!recording) return recording.error().message.empty() ? (std::abort(), 0) : 0;
  const auto written = scree::config::write_recording(*recording);
  const auto again = scree::config::parse_recording(written, "written.yaml");
  if (!again || scree::config::write_recording(*again) != written) std::abort();
  return 0;
}
