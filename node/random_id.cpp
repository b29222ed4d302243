#include "node/random_id.hpp"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <sys/random.h>

namespace scree::node {

Result<std::uint64_t> random_id(const std::string& what) {
  std::uint64_t id = 0;
  while (id == 0)
    if (getrandom(&id, sizeof id, 0) != static_cast<ssize_t>(sizeof id) && errno != EINTR)
      return Error{ErrorKind::unavailable, fmt::format("{}: getrandom failed: {}", what, std::strerror(errno))};
  return id;
}

}  // namespace scree::node
