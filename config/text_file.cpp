#include "config/text_file.hpp"

#include <fmt/format.h>
#include <fstream>
#include <system_error>

namespace scree::config {

Result<std::string> read_text_file(const std::filesystem::path& file, const std::string& what) {
  constexpr std::uintmax_t kMaxBytes = 1 << 20;
  std::error_code status;
  if (!std::filesystem::is_regular_file(file, status))
    return Error{ErrorKind::no_input,
                 fmt::format("{}: expected {}, found {}", file.string(), what,
                             std::filesystem::exists(file, status) ? "no regular file" : "no such file")};
  const std::uintmax_t size = std::filesystem::file_size(file, status);
  if (status) return Error{ErrorKind::io, fmt::format("{}: {}", file.string(), status.message())};
  if (size > kMaxBytes)
    return Error{ErrorKind::bad_data,
                 fmt::format("{}: expected {} of at most {} bytes, found {}", file.string(), what, kMaxBytes, size)};
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return Error{ErrorKind::no_input, fmt::format("{}: cannot be opened", file.string())};
  std::string text(static_cast<std::size_t>(size), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size)
    return Error{ErrorKind::io, fmt::format("{}: expected {} bytes, read {}", file.string(), size, stream.gcount())};
  return text;
}

}  // namespace scree::config
