#pragma once
// OpenCV's pictures to files, errors and exceptions to Status. For the adapters of OpenCV only.

#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "core/result.hpp"

namespace scree::io {

/// `paint` returns the picture. Errors: cannot_create.
template <class Paint>
Status write_painting(const std::filesystem::path& file, const Paint& paint) {
  try {
    if (cv::imwrite(file.string(), paint())) return {};
    return Error{ErrorKind::cannot_create, fmt::format("{}: the picture cannot be written", file.string())};
  } catch (const std::exception& error) {
    return Error{ErrorKind::cannot_create,
                 fmt::format("{}: the picture cannot be written: {}", file.string(), error.what())};
  }
}

}  // namespace scree::io
