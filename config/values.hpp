#pragma once
// Scalars and lists of YAML to C++ values and back. Nothing is converted that does not fit; a text that is written is
// read back to the same bits.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/yaml.hpp"
#include "core/time.hpp"

namespace scree::config {

std::optional<double> read_number(const YamlNode& node);         ///< finite, decimal, no leading zeros ("010")
std::optional<std::int64_t> read_integer(const YamlNode& node);  ///< decimal, no leading zeros
std::optional<bool> read_flag(const YamlNode& node);             ///< true | false
std::optional<std::string> read_text(const YamlNode& node);
std::optional<std::vector<double>> read_numbers(const YamlNode& node);
std::optional<Duration> read_seconds(const YamlNode& node);

std::string write_number(double value);
std::string write_text(const std::string& value);
std::string write_numbers(const std::vector<double>& values);

/// "ADDRESS:PORT" with an IPv4 address in dotted decimals and a port from `min_port` to 65535.
bool is_endpoint(const std::string& text, int min_port);
bool is_ipv4(const std::string& text);

}  // namespace scree::config
