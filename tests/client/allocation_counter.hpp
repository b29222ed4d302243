#pragma once
// Counts every operator new of this test binary (allocation_counter.cpp replaces it).

#include <cstdint>

namespace scree::test {

std::uint64_t allocation_count();

}  // namespace scree::test
