#pragma once
// Data that is not part of the repository: real recordings and terrain, when a checkout has them beside it.

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

namespace scree::test {

/// `<shared>/data/<relative>` where it exists; <shared> is $SCREE_SHARED or `shared` beside the source tree.
/// Callers skip with a printed reason otherwise.
inline std::optional<std::filesystem::path> shared_data(std::string_view relative) {
  const char* variable = std::getenv("SCREE_SHARED");
  const std::filesystem::path shared =
      variable != nullptr ? std::filesystem::path(variable) : std::filesystem::path(SCREE_SOURCE_DIR) / ".." / "shared";
  const auto path = shared / "data" / relative;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  return path;
}

}  // namespace scree::test

#define SCREE_SKIP_WITHOUT(path, relative) \
  if (!(path)) GTEST_SKIP() << "shared data '" << (relative) << "' is not beside this checkout"
