#pragma once
// NumPy's .npy, float32, C order, two dimensions.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::io {

/// Format version 1.0, little-endian. Row 0 first. Errors: cannot_create, io.
Status write_npy(const std::filesystem::path& file, const Grid<float>& grid);

/// Errors: no_input, io, and those of parse_npy.
Result<Grid<float>> read_npy(const std::filesystem::path& file);

/// The bytes of a whole file, versions 1.0 to 3.0, dtype `<f4`, C order, one (a single row) or two dimensions, nothing
/// behind the data. Errors: bad_data (naming `name` and the byte offset).
Result<Grid<float>> parse_npy(std::span<const std::byte> bytes, const std::string& name);

}  // namespace scree::io
