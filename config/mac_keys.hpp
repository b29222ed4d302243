#pragma once
// publish.keys: the keys of the datagrams' MAC, given as hexadecimal digits or as files that hold them.

#include <optional>
#include <string>
#include <vector>

#include "config/schema.hpp"
#include "config/settings.hpp"
#include "core/result.hpp"

namespace scree::config {

/// A list of at most two {id, hex} or {id, file}, the ids different. The flaw of a list that is none; nothing of a key
/// is in it. Reads the files.
std::optional<Flaw> read_keys(const YamlNode& node, std::vector<KeySettings>& keys);

/// YAML with the ids and the files; "hidden" stands for a key that was given as digits.
std::string write_keys(const std::vector<KeySettings>& keys);

/// The key `keys` of the configuration's section "publish".
Key<PublishSettings> mac_keys();

/// The key in a file of 64 hexadecimal digits (and white space around them). Errors: no_input, bad_data, io.
Result<KeySettings> read_key_file(std::uint16_t id, const std::string& file);

}  // namespace scree::config
