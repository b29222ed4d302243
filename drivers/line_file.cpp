#include "drivers/line_file.hpp"

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>

namespace scree::drivers {

LineFile::~LineFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Status LineFile::open(const std::filesystem::path& path) {
  path_ = path;
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ >= 0) return {};
  return Error{ErrorKind::cannot_create, fmt::format("{}: cannot be created: {}", path.string(), std::strerror(errno))};
}

Status LineFile::write(const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = ::write(descriptor_, text.data() + done, text.size() - done);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if (n < 0 && errno != EINTR) {
      const Status failure = failed();
      if (::ftruncate(descriptor_, size_) == 0) ::lseek(descriptor_, size_, SEEK_SET);  // else the reader cuts it off
      return failure;
    }
  }
  size_ += static_cast<off_t>(text.size());
  return {};
}

Status LineFile::close() {
  if (descriptor_ < 0) return {};
  const bool closed = ::close(std::exchange(descriptor_, -1)) == 0;
  return closed ? Status{} : failed();
}

Status LineFile::failed() const {
  return Error{ErrorKind::io, fmt::format("{}: writing failed: {}", path_.string(), std::strerror(errno))};
}

}  // namespace scree::drivers
