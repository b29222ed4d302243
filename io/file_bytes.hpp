#pragma once
// Whole files in and out of memory, with errors that name the path.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace scree::io {

/// Reads the file into `bytes`, whose allocation is kept between calls. Errors: no_input (absent, unreadable, not a
/// file), bad_data (more than `max_bytes`: nothing is read then), io (reading broke off).
Status read_bytes(const std::filesystem::path& file, std::size_t max_bytes, std::vector<std::uint8_t>& bytes);

/// Creates or replaces the file. Errors: cannot_create, io (a full disk comes out here, not later).
Status write_bytes(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

/// The same memory as text.
inline std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace scree::io
