// The mapper's frame loop takes nothing from the heap once it is warm.

#include <atomic>
#include <cstdlib>
#include <gtest/gtest.h>
#include <malloc.h>

#include "drivers/simulator.hpp"
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

/// Allocations of a drive there and back, after one that warmed the mapper.
long allocations_when_warm(const std::vector<std::shared_ptr<const RangeFrame>>& frames, const MapConfig& config) {
#ifdef SCREE_COUNTS_ALLOCATIONS
  SerialExecutor serial;
  Mapper mapper(config, serial);
  const auto drive = [&] {
    for (const auto& frame : frames) EXPECT_TRUE(mapper.step(*frame));
    for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) EXPECT_TRUE(mapper.step(**frame));
  };
  drive();
  const long before = allocations;
  drive();
  return allocations - before;
#else
  return 0;
#endif
}

TEST(Allocation, AFrameTakesNothingFromTheHeapOnceTheMapperIsWarm) {
#ifndef SCREE_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "allocations are counted with glibc and without sanitizers only";
#endif
  const test::SphericalScanner scanner;
  const auto ground = [](double x, double y) { return 0.08 * std::sin(1.3 * x) * std::cos(0.9 * y); };
  std::vector<std::shared_ptr<const RangeFrame>> frames;
  for (int i = 0; i < 10; ++i)
    frames.push_back(std::make_shared<RangeFrame>(
        scanner.frame(ground, test::at(0.3 * i, 0.1 * i), test::at(0.3 * i + 0.2, 0.1 * i), i)));
  MapConfig config;
  config.size_cells = 100;
  EXPECT_EQ(allocations_when_warm(frames, config), 0);
}

// Phases are resolved against the map, frames are laid onto it: poses err by 3 % of the way and by a degree.
TEST(Allocation, NorDoesOneOfAnySimulatedSensorWithOdometryThatDrifts) {
#ifndef SCREE_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "allocations are counted with glibc and without sanitizers only";
#endif
  for (const char* sensor : {"perceptron-usf", "perceptron-cmu", "lidar64", "depth"}) {
    drivers::SimulatorConfig simulated;
    simulated.terrain = "fbm:2.4,0.08,1,24";
    simulated.sensor = sensor;
    simulated.trajectory = "line:-4,0,0,4,1";
    simulated.frame_period = std::chrono::milliseconds(1300);
    simulated.odometry.drift_share = 0.03;
    simulated.odometry.attitude_rms_rad = 0.0175;
    const auto simulator = drivers::Simulator::make(simulated);
    ASSERT_TRUE(simulator) << simulator.error().message;
    SerialExecutor serial;
    std::vector<std::shared_ptr<const RangeFrame>> frames;
    for (std::size_t i = 0; i < simulator->frame_count(); ++i) {
      const auto frame = simulator->render(i, serial);
      ASSERT_TRUE(frame);
      frames.push_back(simulator->range_frame(*frame, {}));
    }
    MapConfig config;
    config.size_cells = 100;
    EXPECT_EQ(allocations_when_warm(frames, config), 0) << sensor;
  }
}

}  // namespace
}  // namespace scree::mapping
