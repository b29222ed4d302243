#include "io/file_bytes.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <memory>

namespace scree::io {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

}  // namespace

Status read_bytes(const std::filesystem::path& file, std::size_t max_bytes, std::vector<std::uint8_t>& bytes) {
  std::error_code failed;
  const auto status = std::filesystem::status(file, failed);
  if (!std::filesystem::exists(status))
    return Error{ErrorKind::no_input, fmt::format("{}: expected a file, found none", file.string())};
  if (!std::filesystem::is_regular_file(status))
    return Error{ErrorKind::no_input,
                 fmt::format("{}: expected a regular file, found {}", file.string(),
                             std::filesystem::is_directory(status) ? "a directory" : "another kind of entry")};
  const auto size = std::filesystem::file_size(file, failed);
  if (failed) return Error{ErrorKind::no_input, fmt::format("{}: size unknown: {}", file.string(), failed.message())};
  if (size > max_bytes)
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected at most {} bytes, found {}", file.string(), max_bytes, size)};

  const File stream(std::fopen(file.c_str(), "rb"));
  if (!stream)
    return Error{ErrorKind::no_input, fmt::format("{}: cannot be opened: {}", file.string(), std::strerror(errno))};
  std::setvbuf(stream.get(), nullptr, _IONBF, 0);  // one read straight into our memory
  bytes.resize(static_cast<std::size_t>(size));
  const std::size_t got = bytes.empty() ? 0 : std::fread(bytes.data(), 1, bytes.size(), stream.get());
  if (got != bytes.size())
    return Error{ErrorKind::io,
                 fmt::format("{}: expected {} bytes, reading broke off at byte {}", file.string(), bytes.size(), got)};
  return {};
}

Status write_bytes(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  File stream(std::fopen(file.c_str(), "wb"));
  if (!stream)
    return Error{ErrorKind::cannot_create,
                 fmt::format("{}: cannot be created: {}", file.string(), std::strerror(errno))};
  errno = 0;
  const std::size_t put = bytes.empty() ? 0 : std::fwrite(bytes.data(), 1, bytes.size(), stream.get());
  const bool closed = std::fclose(stream.release()) == 0;
  if (put != bytes.size() || !closed)
    return Error{ErrorKind::io, fmt::format("{}: writing {} bytes broke off at byte {}: {}", file.string(),
                                            bytes.size(), put, std::strerror(errno))};
  return {};
}

}  // namespace scree::io
