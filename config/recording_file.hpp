#pragma once
// recording.yaml: read into and written from a RecordingDescription.

#include <filesystem>
#include <string>
#include <string_view>

#include "core/result.hpp"
#include "drivers/recording.hpp"

namespace scree::config {

/// `name` stands in the messages. Errors: bad_data, every fault with name:line:column.
Result<drivers::RecordingDescription> parse_recording(std::string_view text, const std::string& name);

/// Reads `directory`/recording.yaml. Errors: no_input (no such file), bad_data.
Result<drivers::RecordingDescription> read_recording(const std::filesystem::path& directory);

/// The text of a recording.yaml that parse_recording reads back to the same values, to the last bit.
std::string write_recording(const drivers::RecordingDescription& description);

}  // namespace scree::config
