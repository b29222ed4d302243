// The mapper's frame loop takes nothing from the heap once it is warm.

#include <atomic>
#include <cstdlib>
#include <gtest/gtest.h>
#include <malloc.h>

#include "mapping/mapper.hpp"
#include "tests/mapping/range_scene.hpp"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SCREE_COUNTS_ALLOCATIONS 1
#endif

#ifdef SCREE_COUNTS_ALLOCATIONS
namespace {
std::atomic<long> allocations{0};
}

// operator new, Eigen and the C library all end here.
extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT
void* __libc_realloc(void* block, std::size_t size);             // NOLINT
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  ++allocations;
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  ++allocations;
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? 12 : 0;
}
}
#endif

namespace scree::mapping {
namespace {

TEST(Allocation, AFrameTakesNothingFromTheHeapOnceTheMapperIsWarm) {
#ifndef SCREE_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "allocations are counted with glibc and without sanitizers only";
#else
  const test::SphericalScanner scanner;
  const auto ground = [](double x, double y) { return 0.08 * std::sin(1.3 * x) * std::cos(0.9 * y); };
  std::vector<RangeFrame> frames;
  for (int i = 0; i < 10; ++i)
    frames.push_back(scanner.frame(ground, test::at(0.3 * i, 0.1 * i), test::at(0.3 * i + 0.2, 0.1 * i), i));
  MapConfig config;
  config.size_cells = 100;
  SerialExecutor serial;
  Mapper mapper(config, serial);
  const auto drive = [&] {
    for (const RangeFrame& frame : frames) ASSERT_TRUE(mapper.step(frame));
    for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) ASSERT_TRUE(mapper.step(*frame));
  };
  drive();
  const long before = allocations;
  drive();
  EXPECT_EQ(allocations - before, 0);
#endif
}

}  // namespace
}  // namespace scree::mapping
