#pragma once
// Numbers that tell one run of a process from every other.

#include <cstdint>

#include "core/result.hpp"

namespace scree::node {

/// Never 0. Errors: unavailable (the kernel gives none).
Result<std::uint64_t> random_id();

}  // namespace scree::node
