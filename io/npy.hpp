#pragma once
// NumPy's .npy, float32, C order, two dimensions.

#include <filesystem>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::io {

Status write_npy(const std::filesystem::path& file, const Grid<float>& grid);
Result<Grid<float>> read_npy(const std::filesystem::path& file);

}  // namespace scree::io
