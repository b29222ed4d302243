#pragma once
// Reads client/golden/NAME.hex: comment lines begin with '#', the rest is bytes in hexadecimal.

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace scree::test {

inline std::vector<std::uint8_t> golden(const std::string& name) {
  std::ifstream file(std::string(SCREE_SOURCE_DIR) + "/client/golden/" + name + ".hex");
  std::vector<std::uint8_t> bytes;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;) bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

}  // namespace scree::test
