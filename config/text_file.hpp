#pragma once

#include <filesystem>
#include <string>

#include "core/result.hpp"

namespace scree::config {

/// A whole small file. `what` says what was expected there. Errors: no_input, bad_data (more than 1 MiB), io.
Result<std::string> read_text_file(const std::filesystem::path& file, const std::string& what);

}  // namespace scree::config
