#pragma once
// A testbed of umockdev: the process sees the testbed's /dev and /sys instead of the machine's. One at a time.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <umockdev.h>

namespace scree::test {

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};

class Testbed {
 public:
  Testbed() {
    bed_.reset(umockdev_testbed_new());
    gchar* root = umockdev_testbed_get_root_dir(bed_.get());
    root_ = root;
    g_free(root);
    // Without the preloaded library the tests would talk to the devices of this machine. umockdev's own question
    // (umockdev_in_mock_environment) says no in containers without sysfs.
    std::filesystem::create_directories(root_ + "/dev");
    std::ofstream(root_ + "/dev/scree-testbed") << root_;
    if (std::filesystem::exists("/dev/scree-testbed")) return;
    ADD_FAILURE() << "expected to run with LD_PRELOAD=libumockdev-preload.so.0 (umockdev-wrapper), found none";
    std::abort();
  }

  UMockdevTestbed* get() const { return bed_.get(); }
  /// What is `/dev/x` to the tested code is `root() + "/dev/x"` to the test.
  const std::string& root() const { return root_; }

 private:
  std::unique_ptr<UMockdevTestbed, Unref> bed_;
  std::string root_;
};

}  // namespace scree::test
