// Writing of Perceptron range files; reading is in perceptron_file.cpp.

#include <algorithm>
#include <fmt/format.h>

#include "drivers/perceptron_file.hpp"

namespace scree::drivers {
namespace {

/// The published numbers of tokens on header lines 3..10; their meaning is not known.
constexpr std::array<int, 8> kHeaderTokens{3, 3, 3, 3, 4, 4, 3, 5};

std::string usf_header(const RangeFile& file) {
  std::string text = fmt::format("rows: {}\ncolumns: {}\n", file.raw.rows(), file.raw.columns());
  for (std::size_t i = 0; i < kHeaderTokens.size(); ++i) {
    std::string line = file.header[i + 2];
    for (int token = 0; file.header[i + 2].empty() && token < kHeaderTokens[i]; ++token)
      line += token == 0 ? "0" : " 0";
    text += line + '\n';
  }
  return text + '\n';
}

Error refused(const std::string& what) {
  return {ErrorKind::bad_data, "range file to write: " + what};
}

Status check_values(const Grid<std::uint16_t>& grid, const char* what) {
  const auto bad = std::find_if(grid.begin(), grid.end(), [](std::uint16_t v) { return v > kPerceptronMaxRaw; });
  if (bad == grid.end()) return {};
  const auto i = bad - grid.begin();
  return refused(fmt::format("expected {} 0..4095, found {} in row {}, column {}", what, *bad, i / grid.columns(),
                             i % grid.columns()));
}

Status check(const RangeFile& file, int shift) {
  const auto& raw = file.raw;
  if (raw.rows() < 1 || raw.rows() > kRangeFileMaxSide || raw.columns() < 1 || raw.columns() > kRangeFileMaxSide)
    return refused(
        fmt::format("expected 1..{} rows and columns, found {} x {}", kRangeFileMaxSide, raw.rows(), raw.columns()));
  if (file.layout != RangeFileLayout::usf && (raw.rows() != kCmuSide || raw.columns() != kCmuSide))
    return refused(
        fmt::format("expected 256 x 256 for {}, found {} x {}", to_string(file.layout), raw.rows(), raw.columns()));
  if (const auto values = check_values(raw, "ranges"); !values) return values;
  for (const std::string& line : file.header)
    if (line.find_first_of("\r\n") != std::string::npos) return refused("expected header lines without line ends");
  if (shift == 0) return {};
  if (shift != 12 && shift != 16)
    return refused(fmt::format("expected reflectance_shift 12, 16 or 0, found {}", shift));
  if (file.layout == RangeFileLayout::cmu_ranges) return refused("2-byte ranges have no place for the reflectance");
  if (file.reflectance.rows() != raw.rows() || file.reflectance.columns() != raw.columns())
    return refused(fmt::format("expected a reflectance of {} x {}, found {} x {}", raw.rows(), raw.columns(),
                               file.reflectance.rows(), file.reflectance.columns()));
  return check_values(file.reflectance, "reflectances");
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_range_file(const RangeFile& file, int reflectance_shift) {
  if (const auto checked = check(file, reflectance_shift); !checked) return checked.error();
  const std::string header = file.layout == RangeFileLayout::usf ? usf_header(file) : std::string();
  if (header.size() > kRangeFileMaxHeader)
    return refused(fmt::format("expected a header of at most {} bytes, found {}", kRangeFileMaxHeader, header.size()));
  const std::size_t word = file.layout == RangeFileLayout::cmu_ranges ? 2 : 4;
  std::vector<std::uint8_t> bytes(header.size() + word * file.raw.size());
  std::copy(header.begin(), header.end(), bytes.begin());
  std::uint8_t* out = bytes.data() + header.size();
  for (std::size_t i = 0; i < file.raw.size(); ++i) {
    std::uint32_t value = file.raw[i];
    if (reflectance_shift != 0) value |= std::uint32_t{file.reflectance[i]} << reflectance_shift;
    for (std::size_t b = 0; b < word; ++b) *out++ = static_cast<std::uint8_t>(value >> (8 * (word - 1 - b)));
  }
  return bytes;
}

}  // namespace scree::drivers
