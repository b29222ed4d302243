#pragma once
// A YAML document as plain values with positions: the only thing the rest of config/ knows of YAML.

#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace scree::config {

/// Lines and columns count from 1; 0 = no position (a value of the command line).
struct YamlNode {
  enum class Kind { null, scalar, sequence, map };
  Kind kind = Kind::null;
  int line = 0;
  int column = 0;
  std::string scalar;
  bool quoted = false;          ///< "5" in quotes is a text, not a number
  std::vector<YamlNode> keys;   ///< of a map, parallel to `items`; duplicates are kept
  std::vector<YamlNode> items;  ///< elements of a sequence, values of a map
};

/// Parses one document; an empty text is a null node. Errors are bad_data with `name:line:column`: syntax, more than
/// one document, more than 1 MiB, and documents that aliases blow up beyond 100,000 nodes or 32 levels.
Result<YamlNode> parse_yaml(std::string_view text, const std::string& name);

/// How a message shows what was found: "'abc'", "a map", "a list of 3", "nothing".
std::string describe(const YamlNode& node);

}  // namespace scree::config
