#pragma once
// A text file that grows by whole lines.

#include <filesystem>
#include <string>
#include <sys/types.h>

#include "core/result.hpp"

namespace scree::drivers {

/// A line is handed to the kernel at once, or not at all: what a full disk took a part of is cut off again.
class LineFile {
 public:
  LineFile() = default;
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;
  ~LineFile();

  /// Creates or empties it. Errors: cannot_create.
  Status open(const std::filesystem::path& path);
  /// `text` is whole lines. Errors: io.
  Status write(const std::string& text);
  Status close();

 private:
  Status failed() const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  off_t size_ = 0;  ///< of whole lines
};

}  // namespace scree::drivers
