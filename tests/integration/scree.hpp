#pragma once
// The real binary, and a small recording that it simulates once.

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include "tests/support/process.hpp"

namespace scree::test {

inline std::vector<std::string> command(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), SCREE_BINARY);
  return arguments;
}

inline Finished scree(std::vector<std::string> arguments) {
  return run(command(std::move(arguments)));
}

/// A loopback address that no other test process uses; `i` tells those of one process apart. Below 32768, where the
/// kernel's own choices begin.
inline std::string address(int i) {
  return "127.0.0.1:" + std::to_string(20000 + (static_cast<int>(getpid()) * 8 + i) % 12000);
}

/// Options that keep a replay off the default ports.
inline std::vector<std::string> replay(const std::string& recording, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{
      "replay", recording, "--set", "publish.listen=127.0.0.1:0", "--set", "publish.destination=" + address(0)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

inline std::string read_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Seven frames (3 s) of the CMU scanner over 12 m × 30 m of rough ground.
inline const std::filesystem::path& small_recording() {
  static const TemporaryFolder folder;
  static const std::filesystem::path recording = [] {
    const auto path = folder / "recording";
    const auto made = scree({"simulate", "--terrain", "fbm:2.3,0.1,7,30,0.1", "--sensor", "perceptron-cmu",
                             "--trajectory", "line:-6,0,0,3,1.0", "--out", path.string()});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return path;
  }();
  return recording;
}

/// A copy that a test may spoil.
inline std::filesystem::path copy_of_recording(const TemporaryFolder& folder) {
  const auto copy = folder / "copy";
  std::filesystem::copy(small_recording(), copy, std::filesystem::copy_options::recursive);
  return copy;
}

}  // namespace scree::test
