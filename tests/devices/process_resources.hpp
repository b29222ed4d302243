#pragma once
// What the kernel holds for this process, to see whether it grows.

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <string>
#include <thread>

namespace scree::test {

struct Resources {
  std::ptrdiff_t descriptors = 0, threads = 0;
  std::ptrdiff_t mappings = 0;  ///< of `file`

  friend bool operator==(const Resources&, const Resources&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Resources& r) {
    return out << r.descriptors << " descriptors, " << r.threads << " threads, " << r.mappings << " mappings";
  }
};

inline std::ptrdiff_t entries(const char* folder) {
  return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}

inline Resources resources(const std::string& file) {
  Resources out{entries("/proc/self/fd"), entries("/proc/self/task"), 0};
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) out.mappings += line.find(file) != std::string::npos ? 1 : 0;
  return out;
}

/// The testbed's thread closes its end of a descriptor some time after the driver has closed its own: waits, at most
/// 10 s, until what is held is `expected`.
inline Resources settled(const std::string& file, const Resources& expected) {
  Resources now = resources(file);
  for (int i = 0; i < 1000 && now != expected; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    now = resources(file);
  }
  return now;
}

}  // namespace scree::test
