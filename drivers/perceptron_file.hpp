#pragma once
// Range files of the Perceptron scanners: the USF layout (text header, 4-byte words) and the two headerless layouts of
// the CMU outdoor unit, told apart by their size. Formats: [HJ96] and its two public readers; docs/perceptron.md.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::drivers {

enum class RangeFileLayout : std::uint8_t {
  usf,         ///< 10 header lines, an empty line, rows × columns big-endian 4-byte words
  cmu_words,   ///< 256 × 256 big-endian 4-byte words, no header: 262,144 bytes
  cmu_ranges,  ///< 256 × 256 big-endian 2-byte ranges, no header: 131,072 bytes
};
const char* to_string(RangeFileLayout layout);

struct RangeFileOptions {
  int reflectance_shift = 0;  ///< 12 | 16: where the reflectance lies in a word; 0 = unknown, not decoded
  bool lenient = false;       ///< accept 1..4096 bytes of printable text between header and payload, with a warning
};

/// One decoded file. Grids are rows × columns, row 0 the top, column 0 the left, values 0..4095; every value is legal
/// data as far as the format goes.
struct RangeFile {
  RangeFileLayout layout = RangeFileLayout::usf;
  std::array<std::string, 10> header;  ///< the lines of a USF header without their ends; empty for CMU
  Grid<std::uint16_t> raw;
  Grid<std::uint16_t> reflectance;  ///< empty unless the options say where it is
  std::string warning;              ///< what `lenient` let pass; empty otherwise
};

inline constexpr int kRangeFileMaxSide = 4096;              ///< rows and columns are 1..4096
inline constexpr std::size_t kRangeFileMaxHeader = 4096;    ///< the header ends within the first 4 KiB
inline constexpr int kCmuSide = 256;                        ///< rows and columns of headerless files
inline constexpr std::uint16_t kPerceptronMaxRaw = 0x0FFF;  ///< 12 bits
inline constexpr std::size_t kRangeFileMaxBytes = 4u * kRangeFileMaxSide * kRangeFileMaxSide + 2 * kRangeFileMaxHeader;

/// Decodes a file held in memory into `out`, whose allocations are kept. A file whose first line is text with a colon
/// is USF whatever its size (a USF file cut to 256 KiB is no CMU frame); any other is CMU by its size or refused.
/// `name` begins every message. Errors: bad_data with expected, found and byte offset; `out` is unspecified then.
/// Cost: one pass over the words, about 0.03 ms for 256 × 256.
Status parse_range_file(std::span<const std::uint8_t> bytes, const std::string& name, const RangeFileOptions& options,
                        RangeFile& out);

/// Errors: no_input, io, and those of parse_range_file.
Result<RangeFile> read_range_file(const std::filesystem::path& file, const RangeFileOptions& options = {});

/// The bytes of `file` in its layout. The header's first two lines are replaced by "rows: R" and "columns: C"; empty
/// lines 3..10 become zeros in the published number of tokens. The reflectance is written where reflectance_shift says
/// (0: not at all). Errors: bad_data (a value above 4095, a shape that the layout or the format cannot hold).
Result<std::vector<std::uint8_t>> encode_range_file(const RangeFile& file, int reflectance_shift = 0);

}  // namespace scree::drivers
