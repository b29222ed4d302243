#include "io/npy.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <string_view>
#include <vector>

#include "io/file_bytes.hpp"

namespace scree::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the data part is copied as it lies in memory");

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kMaxBytes = std::size_t{1} << 32;
constexpr std::size_t kAlignment = 64;  // of the data part, as NumPy writes it

Error bad(const std::string& name, std::size_t offset, std::string_view expected, std::string_view found) {
  return {ErrorKind::bad_data, fmt::format("{}: byte {}: expected {}, found {}", name, offset, expected, found)};
}

struct Header {
  std::string_view text;  ///< the Python dictionary
  std::size_t data_offset = 0;
};

Result<Header> find_header(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with(kMagic)) return bad(name, 0, "the .npy magic", fmt::format("{} other bytes", bytes.size()));
  if (bytes.size() < 10) return bad(name, 6, "a format version and a header length", "the end of the file");
  const auto byte = [&](std::size_t i) { return std::size_t{static_cast<unsigned char>(bytes[i])}; };
  const std::size_t major = byte(6);
  if (major < 1 || major > 3) return bad(name, 6, "format version 1, 2 or 3", fmt::format("{}", major));
  const std::size_t begin = major == 1 ? 10 : 12;
  if (bytes.size() < begin) return bad(name, 8, "a header length", "the end of the file");
  std::size_t length = byte(8) | byte(9) << 8;
  if (major > 1) length |= byte(10) << 16 | byte(11) << 24;
  if (length > bytes.size() - begin)
    return bad(name, begin, fmt::format("a header of {} bytes", length), fmt::format("{} bytes", bytes.size() - begin));
  return Header{bytes.substr(begin, length), begin + length};
}

/// What follows `'key':` in the dictionary, without leading blanks; empty where the key is not there.
std::string_view value_of(std::string_view header, std::string_view key) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = fmt::format("{0}{1}{0}", quote, key);
    auto at = header.find(quoted);
    if (at == std::string_view::npos) continue;
    at = header.find_first_not_of(" ", at + quoted.size());
    if (at == std::string_view::npos || header[at] != ':') return {};
    at = header.find_first_not_of(" ", at + 1);
    return at == std::string_view::npos ? std::string_view{} : header.substr(at);
  }
  return {};
}

/// "(3, 4)" or "(4,)"; false for anything else.
bool parse_shape(std::string_view text, std::vector<std::int64_t>& shape) {
  const auto close = text.find(')');
  if (!text.starts_with('(') || close == std::string_view::npos) return false;
  text = text.substr(1, close - 1);
  while (!text.empty()) {
    const auto begin = text.find_first_not_of(' ');
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    std::int64_t size = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), size);
    if (status != std::errc{} || size < 0) return false;
    shape.push_back(size);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    const auto next = text.find_first_not_of(' ');
    if (next == std::string_view::npos) break;
    if (text[next] != ',') return false;
    text.remove_prefix(next + 1);
  }
  return !shape.empty();
}

std::string quoted_start(std::string_view text) {
  return text.empty() ? std::string("nothing") : fmt::format("'{}'", text.substr(0, 24));
}

}  // namespace

Result<Grid<float>> parse_npy(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto header = find_header(text, name);
  if (!header) return header.error();
  const std::size_t at = header->data_offset - header->text.size();

  const auto type = value_of(header->text, "descr");
  if (!type.starts_with("'<f4'") && !type.starts_with("\"<f4\""))
    return bad(name, at, "descr '<f4' (float32)", quoted_start(type));
  const auto order = value_of(header->text, "fortran_order");
  if (!order.starts_with("False")) return bad(name, at, "fortran_order False", quoted_start(order));
  std::vector<std::int64_t> shape;
  const auto shape_text = value_of(header->text, "shape");
  if (!parse_shape(shape_text, shape) || shape.size() > 2)
    return bad(name, at, "a shape of one or two dimensions", quoted_start(shape_text));

  const std::int64_t rows = shape.size() == 2 ? shape[0] : 1;
  const std::int64_t columns = shape.back();
  const auto limit = std::int64_t{std::numeric_limits<int>::max()};
  if (rows > limit || columns > limit) return bad(name, at, "a shape below 2^31", quoted_start(shape_text));
  const auto cells = static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(columns);
  const std::size_t data_bytes = bytes.size() - header->data_offset;
  if (data_bytes % sizeof(float) != 0 || data_bytes / sizeof(float) != cells)
    return bad(name, header->data_offset, fmt::format("{} × {} float32", rows, columns),
               fmt::format("{} bytes", data_bytes));
  Grid<float> grid(static_cast<int>(rows), static_cast<int>(columns));
  if (data_bytes > 0) std::memcpy(grid.data(), bytes.data() + header->data_offset, data_bytes);
  return grid;
}

Result<Grid<float>> read_npy(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes;
  if (auto status = read_bytes(file, kMaxBytes, bytes); !status) return status.error();
  return parse_npy(std::as_bytes(std::span(bytes)), file.string());
}

Status write_npy(const std::filesystem::path& file, const Grid<float>& grid) {
  std::string header =
      fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}), }}", grid.rows(), grid.columns());
  const std::size_t before_data = kMagic.size() + 4 + header.size() + 1;
  header.append((kAlignment - before_data % kAlignment) % kAlignment, ' ');
  header += '\n';
  std::vector<std::uint8_t> bytes(kMagic.begin(), kMagic.end());
  const std::array<std::uint8_t, 4> version_and_length{1, 0, static_cast<std::uint8_t>(header.size() & 0xff),
                                                       static_cast<std::uint8_t>(header.size() >> 8)};
  bytes.insert(bytes.end(), version_and_length.begin(), version_and_length.end());
  bytes.insert(bytes.end(), header.begin(), header.end());
  const std::size_t data_offset = bytes.size();
  bytes.resize(data_offset + grid.size() * sizeof(float));
  if (!grid.empty()) std::memcpy(bytes.data() + data_offset, grid.data(), grid.size() * sizeof(float));
  return write_bytes(file, bytes);
}

}  // namespace scree::io
