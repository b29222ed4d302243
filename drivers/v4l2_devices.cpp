#include "drivers/v4l2_devices.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

namespace scree::drivers {
namespace {

namespace fs = std::filesystem;

/// The number of a node /dev/videoN.
std::optional<int> number_of(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::string_view kName = "video";
  if (!name.starts_with(kName)) return std::nullopt;
  int number = 0;
  const char* end = name.data() + name.size();
  const auto [stop, status] = std::from_chars(name.data() + kName.size(), end, number);
  return status == std::errc{} && stop == end ? std::optional(number) : std::nullopt;
}

std::vector<fs::path> entries_of(const char* folder) {
  std::vector<fs::path> out;
  std::error_code error;  // a folder that is not there has no entries
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    out.push_back(it->path());
  std::sort(out.begin(), out.end());
  return out;
}

/// Number of a node → its link.
std::map<int, std::string> stable_links() {
  std::map<int, std::string> out;
  for (const fs::path& link : entries_of("/dev/v4l/by-id")) {
    std::error_code error;
    const auto number = number_of(fs::read_symlink(link, error));
    if (!error && number) out.emplace(*number, link.string());
  }
  return out;
}

void ask(V4l2DeviceInfo& info) {
  const auto handle = v4l2::Handle::open(info.path);
  if (!handle) {
    info.reason = handle.error().message;
    return;
  }
  auto capabilities = v4l2::read_capabilities(*handle, info.path);
  if (!capabilities) {
    info.reason = capabilities.error().message;
    return;
  }
  info.capabilities = *std::move(capabilities);
  info.reason = v4l2::why_unusable(info.capabilities);
}

}  // namespace

std::vector<V4l2DeviceInfo> list_v4l2_devices() {
  std::map<int, V4l2DeviceInfo> found;
  const auto links = stable_links();
  for (const fs::path& path : entries_of("/dev")) {
    const auto number = number_of(path);
    if (!number) continue;
    V4l2DeviceInfo info;
    info.path = path.string();
    if (const auto link = links.find(*number); link != links.end()) info.stable = link->second;
    ask(info);
    found.emplace(*number, std::move(info));
  }
  std::vector<V4l2DeviceInfo> out;
  out.reserve(found.size());
  for (auto& [number, info] : found) out.push_back(std::move(info));
  return out;
}

}  // namespace scree::drivers
