#pragma once
// Settings from YAML and the command line, all faults at once; and back to YAML.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/settings.hpp"
#include "core/result.hpp"

namespace scree::config {

/// Defaults, then `file` (none: defaults alone), then each "key=value" of `assignments`. Errors: no_input (no such
/// file), bad_config with one line a fault: `file:line:column: key: expected …, found …` (`--set` for assignments).
Result<Settings> load_settings(const std::optional<std::filesystem::path>& file,
                               const std::vector<std::string>& assignments);

/// The same from text in memory; `name` stands in the messages.
Result<Settings> parse_settings(std::string_view text, const std::string& name,
                                const std::vector<std::string>& assignments = {});

/// The canonical effective configuration: every key that applies, in a fixed order, as YAML that parses back to the
/// same settings. Its hash is the protocol's config_hash.
std::string dump_settings(const Settings& settings);

/// What to use for a source that says `recorded` of itself (none: it says nothing). Errors: bad_config when the
/// given keys contradict the recording's.
Result<SensorConfig> effective_sensor(const SensorSettings& settings, const std::optional<SensorConfig>& recorded);

/// The table of all keys in docs/configuration.md (Markdown).
std::string settings_table();

}  // namespace scree::config
