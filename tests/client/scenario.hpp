#pragma once
// Files shared by the tests of both clients: golden vectors and the scenarios of client/golden/generate_scenarios.py.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace scree::test {

inline std::filesystem::path golden_folder() {
  return std::filesystem::path(SCREE_SOURCE_DIR) / "client" / "golden";
}

inline std::vector<std::uint8_t> from_hex(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  std::string digits;
  for (const char c : text) {
    if (c == ' ' || c == '\n') continue;
    digits += c;
    if (digits.size() < 2) continue;
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(digits, nullptr, 16)));
    digits.clear();
  }
  return bytes;
}

inline std::vector<std::uint8_t> golden_vector(const std::string& name) {
  std::ifstream stream(golden_folder() / (name + ".hex"));
  std::string line, text;
  while (std::getline(stream, line))
    if (!line.starts_with("#")) text += line + ' ';
  return from_hex(text);
}

struct ScenarioLine {
  int number = 0;
  std::string text;
  std::vector<std::string> words;
};

inline std::vector<ScenarioLine> read_scenario(const std::filesystem::path& file) {
  std::vector<ScenarioLine> lines;
  std::ifstream stream(file);
  std::string text;
  for (int number = 1; std::getline(stream, text); ++number) {
    if (text.starts_with("#")) continue;
    ScenarioLine line{number, text, {}};
    std::istringstream words(text);
    for (std::string word; words >> word;) line.words.push_back(word);
    lines.push_back(line);
  }
  return lines;
}

}  // namespace scree::test
