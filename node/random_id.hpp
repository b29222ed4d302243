#pragma once

#include <cstdint>
#include <string>

#include "core/result.hpp"

namespace scree::node {

/// From the kernel; never 0. Errors: unavailable, naming `what`.
Result<std::uint64_t> random_id(const std::string& what);

}  // namespace scree::node
