// The edges of the house: which folder may include what. The rules stand in docs/decisions.md; this test reads the
// #include lines and fails on any other.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace scree {
namespace {

namespace fs = std::filesystem;

/// Longest matching folder wins; `ours` are folders of the house, `foreign` prefixes of third-party headers.
struct Rule {
  std::set<std::string> ours;
  std::set<std::string> foreign;
};

const std::map<std::string, Rule> kFolders{
    {"core", {{"core"}, {"Eigen/"}}},
    {"io", {{"core", "io"}, {"Eigen/", "fmt/"}}},
    {"drivers/frame", {{"core", "drivers/frame"}, {"Eigen/", "fmt/"}}},
    {"drivers", {{"core", "io", "drivers/frame", "drivers"}, {"Eigen/", "fmt/"}}},
    {"fractal", {{"core", "fractal"}, {"Eigen/", "fmt/"}}},
    {"fractal/reconstruction", {{"core", "fractal", "fractal/reconstruction"}, {"Eigen/", "fmt/"}}},
    {"mapping", {{"core", "drivers/frame", "fractal", "fractal/reconstruction", "mapping"}, {"Eigen/", "fmt/"}}},
    {"config",
     {{"core", "drivers", "drivers/frame", "mapping", "fractal", "fractal/reconstruction", "config"},
      {"Eigen/", "fmt/"}}},
    {"node",
     {{"core", "io", "drivers", "drivers/frame", "fractal", "fractal/reconstruction", "mapping", "config", "node",
       "client", "client/examples"},
      {"Eigen/", "fmt/", "CLI/", "spdlog/", "nlohmann/", "sodium.h", "zlib.h", "sys/socket.h", "netinet/",
       "arpa/inet.h", "netdb.h", "sys/random.h", "sys/timex.h", "sys/epoll.h", "sys/eventfd.h", "sys/signalfd.h",
       "poll.h", "pthread.h"}}},
    {"client/examples", {{"client", "client/examples"}, {}}},
    {"client", {{}, {"sys/socket.h", "netinet/in.h", "arpa/inet.h", "poll.h", "sys/random.h", "time.h"}}},
};

/// Adapter files: what each may include beyond its folder's rule.
const std::map<std::string, Rule> kAdapters{
    {"io/raster.cpp", {{}, {"gdal", "cpl_", "ogr_"}}},
    {"io/point_cloud.cpp", {{}, {"pcl/"}}},
    {"io/picture.cpp", {{}, {"opencv2/"}}},
    {"io/drawing.cpp", {{}, {"opencv2/"}}},
    {"io/opencv_file.hpp", {{}, {"opencv2/"}}},
    {"fractal/fourier.cpp", {{}, {"unsupported/Eigen/FFT"}}},
    {"drivers/terrain_load.cpp", {{"fractal"}, {}}},
    {"drivers/checksum.cpp", {{}, {"zlib.h"}}},
    {"drivers/stream_socket.cpp", {{}, {"sys/socket.h", "sys/un.h", "netinet/", "arpa/inet.h", "poll.h"}}},
    {"drivers/usbredir_port.hpp", {{}, {"usbredirparser.h"}}},
    {"drivers/usb_context.cpp", {{}, {"libusb.h"}}},
    {"drivers/usb_devices.cpp", {{}, {"libusb.h"}}},
    {"drivers/usb_interface.cpp", {{}, {"libusb.h"}}},
    {"drivers/usb_link.cpp", {{}, {"libusb.h"}}},
    {"drivers/usb_transfers.cpp", {{}, {"libusb.h"}}},
    {"drivers/v4l2_handle.cpp", {{}, {"poll.h", "sys/ioctl.h"}}},
    {"drivers/v4l2_capabilities.cpp", {{}, {"linux/videodev2.h"}}},
    {"drivers/v4l2_device.cpp", {{}, {"linux/videodev2.h", "sys/mman.h"}}},
    {"config/yaml.cpp", {{}, {"yaml-cpp/"}}},
    {"node/service_notify.cpp", {{}, {"sys/un.h"}}},
};

/// C++20 and C headers, and the POSIX ones for files and processes.
const std::set<std::string> kStandard{"algorithm",     "any",
                                      "array",         "atomic",
                                      "barrier",       "bit",
                                      "bitset",        "cassert",
                                      "cctype",        "cerrno",
                                      "cfloat",        "charconv",
                                      "chrono",        "cinttypes",
                                      "climits",       "cmath",
                                      "compare",       "complex",
                                      "concepts",      "condition_variable",
                                      "csignal",       "cstddef",
                                      "cstdint",       "cstdio",
                                      "cstdlib",       "cstring",
                                      "ctime",         "deque",
                                      "exception",     "filesystem",
                                      "fstream",       "functional",
                                      "future",        "initializer_list",
                                      "iomanip",       "iosfwd",
                                      "iostream",      "istream",
                                      "iterator",      "latch",
                                      "limits",        "list",
                                      "locale",        "map",
                                      "memory",        "mutex",
                                      "new",           "numbers",
                                      "numeric",       "optional",
                                      "ostream",       "queue",
                                      "random",        "ranges",
                                      "ratio",         "regex",
                                      "semaphore",     "set",
                                      "shared_mutex",  "source_location",
                                      "span",          "sstream",
                                      "stack",         "stdexcept",
                                      "stop_token",    "streambuf",
                                      "string",        "string_view",
                                      "system_error",  "thread",
                                      "tuple",         "type_traits",
                                      "typeindex",     "unordered_map",
                                      "unordered_set", "utility",
                                      "variant",       "vector",
                                      "version",       "fcntl.h",
                                      "signal.h",      "unistd.h",
                                      "sys/stat.h",    "sys/types.h",
                                      "sys/uio.h",     "sys/resource.h",
                                      "sys/time.h"};

struct Include {
  std::string file;  ///< relative to the source tree
  int line = 0;
  std::string header;
  bool quoted = false;
};

/// "drivers/frame/pose.hpp" → "drivers/frame"; "node/commands/run.hpp" → "node": the longest folder with a rule.
std::string room_of(const std::string& path) {
  std::string room = path.substr(0, path.find('/'));
  for (const auto& [folder, rule] : kFolders)
    if (folder.size() > room.size() && path.starts_with(folder + '/')) room = folder;
  return room;
}

std::vector<Include> read_includes() {
  const fs::path root = SCREE_SOURCE_DIR;
  const std::regex pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::vector<Include> includes;
  for (const auto& [folder, rule] : kFolders) {
    if (!fs::exists(root / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".hpp" && extension != ".cpp") continue;
      const std::string file = fs::relative(entry.path(), root).string();
      if (room_of(file) != folder) continue;
      std::ifstream stream(entry.path());
      std::string text;
      for (int line = 1; std::getline(stream, text); ++line) {
        std::smatch match;
        if (std::regex_search(text, match, pattern))
          includes.push_back({file, line, match[2].str(), match[1].str() == "\""});
      }
    }
  }
  return includes;
}

bool any_prefix(const std::set<std::string>& prefixes, const std::string& header) {
  return std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& p) { return header.starts_with(p); });
}

bool allowed(const Include& include) {
  const Rule& rule = kFolders.at(room_of(include.file));
  const auto adapter = kAdapters.find(include.file);
  const Rule extra = adapter == kAdapters.end() ? Rule{} : adapter->second;
  if (include.quoted) {
    const std::string room = room_of(include.header);
    return rule.ours.contains(room) || extra.ours.contains(room);
  }
  return kStandard.contains(include.header) || any_prefix(rule.foreign, include.header) ||
         any_prefix(extra.foreign, include.header);
}

TEST(House, EveryIncludeFollowsAnEdge) {
  const auto includes = read_includes();
  ASSERT_GT(includes.size(), 100u) << "the source tree was not found at " << SCREE_SOURCE_DIR;
  for (const Include& include : includes)
    EXPECT_TRUE(allowed(include)) << include.file << ':' << include.line << ": " << room_of(include.file)
                                  << " may not include '" << include.header << "'";
}

TEST(House, TheRuleNoticesAForbiddenEdge) {
  EXPECT_FALSE(allowed({"fractal/surface.cpp", 1, "drivers/source.hpp", true}));
  EXPECT_FALSE(allowed({"fractal/surface.cpp", 1, "fractal/reconstruction/multigrid.hpp", true}));
  EXPECT_FALSE(allowed({"mapping/mapper.cpp", 1, "drivers/source.hpp", true}));
  EXPECT_FALSE(allowed({"mapping/mapper.cpp", 1, "opencv2/core.hpp", false}));
  EXPECT_FALSE(allowed({"core/time.cpp", 1, "fmt/format.h", false}));
  EXPECT_FALSE(allowed({"client/scree_client.hpp", 1, "core/grid.hpp", true}));
  EXPECT_TRUE(allowed({"mapping/mapper.cpp", 1, "drivers/frame/range_frame.hpp", true}));
}

TEST(House, EveryAdapterNamedExists) {
  for (const auto& [file, rule] : kAdapters) EXPECT_TRUE(fs::exists(fs::path(SCREE_SOURCE_DIR) / file)) << file;
}

}  // namespace
}  // namespace scree
