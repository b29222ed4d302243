#pragma once
// A depth camera that is not there: /dev/videoN of a testbed, which answers the ioctls of V4L2 and shares its buffers.
// The node is a plain file, so that mmap of the driver's descriptor maps the very bytes that the camera writes.

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "drivers/v4l2_formats.hpp"
#include "tests/devices/testbed.hpp"

namespace scree::test {

/// What one buffer is filled with.
struct Picture {
  std::vector<std::uint16_t> words;  ///< row-major, without padding
  std::uint32_t sequence = 0;
  bool flagged = false;
  bool monotonic = true;
  bool start_of_exposure = true;
  std::optional<MonotonicTime> stamp;      ///< none = when it is taken
  std::optional<std::uint32_t> bytesused;  ///< none = the whole image
};

struct CameraSettings {
  std::string node = "video0";
  std::uint32_t device_caps = 0x04000001;  ///< video capture, streaming
  std::vector<std::uint32_t> formats{drivers::v4l2::fourcc_of("Z16 ")};
  std::uint32_t columns = 8, rows = 6;  ///< the present size, and the only one that is offered
  std::uint32_t padding = 0;            ///< bytes behind each row
  std::uint32_t rate_hz = 30;           ///< the only one
};

/// Answers in the testbed's thread; may be told things from any.
class Camera {
 public:
  Camera(Testbed& bed, CameraSettings settings);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// Fills the next buffer as soon as one is queued.
  void deliver(Picture picture);
  /// Instead of deliver(): every question for a buffer is answered with one of these; null ends it.
  void always(std::function<Picture(std::uint32_t sequence)> make);

  /// The next `times` ioctls of that kind fail with `error`; −1 = all, 0 = none any more.
  void fail(unsigned long request, int error, int times = -1);
  /// Everything fails with ENODEV, as after a plug was pulled, until plug().
  void unplug() { set_plugged(false); }
  void plug() { set_plugged(true); }
  /// The node is there or not.
  void hide_node();
  void show_node();
  void change(const std::function<void(CameraSettings&)>& how);

  struct Counts {
    int started = 0, stopped = 0;
  };
  Counts counts() const;
  std::string path() const { return "/dev/" + node_; }
  const std::string& file() const { return file_; }

 private:
  static gboolean on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
  int answer(unsigned long request, void* argument);
  int describe(unsigned long request, void* argument);
  int negotiate(unsigned long request, void* argument);
  int buffers(unsigned long request, void* argument);
  int take(void* argument);
  void set_plugged(bool plugged);
  std::uint32_t line() const { return 2 * settings_.columns + settings_.padding; }

  mutable std::mutex mutex_;
  Testbed& bed_;
  CameraSettings settings_;
  std::string node_, file_;
  std::unique_ptr<UMockdevIoctlBase, Unref> handler_;
  std::uint8_t* shared_ = nullptr;
  std::map<unsigned long, std::pair<int, int>> faults_;  ///< request → error, how often
  bool plugged_ = true;
  bool streaming_ = false;
  std::uint32_t next_sequence_ = 0;
  std::deque<std::uint32_t> queued_;
  std::deque<Picture> pictures_;
  std::function<Picture(std::uint32_t)> make_;
  Counts counts_;
};

}  // namespace scree::test
