// The testbed itself: what the other tests here stand on.

#include "tests/devices/testbed.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

namespace scree {
namespace {

TEST(Testbed, ItsFilesAreTheDevicesOfTheProcess) {
  const test::Testbed bed;
  EXPECT_FALSE(std::filesystem::exists("/dev/scree-test-node"));
  std::filesystem::create_directories(bed.root() + "/dev");
  std::ofstream(bed.root() + "/dev/scree-test-node") << "x";
  EXPECT_TRUE(std::filesystem::exists("/dev/scree-test-node"));
}

}  // namespace
}  // namespace scree
