#pragma once
// A range scanner on the testbed's USB: what the kernel's usbfs would do with a device is done in the test's own
// process (umockdev catches the ioctls). Descriptors, requests and endpoint as docs/usb-protocol.md has them.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/usb_protocol.hpp"
#include "tests/devices/testbed.hpp"

struct usbdevfs_urb;

namespace scree::test {

using Bytes = std::vector<std::uint8_t>;

/// What test and device agree on; changed by either under the scanner's mutex.
struct ScannerState {
  // what it does
  Bytes info{1, 0, 0, 0, 0, 0, 0x10, 1};
  std::uint8_t protocol = drivers::usb::kInterfaceProtocol;
  std::uint8_t endpoint_type = 2;    ///< bulk
  int claim_error = 0;               ///< errno
  int submit_error = 0;              ///< errno
  bool keeps_transfers = false;      ///< a cancelled transfer does not come back
  bool sends_after_restart = false;  ///< silent until streaming was switched off and on again
  int unplug_status = -108;          ///< ESHUTDOWN: of the transfers in flight when it goes
  // what was asked of it
  int streaming_on = 0, streaming_off = 0, clear_halts = 0, resets = 0, claims = 0, submits = 0;
  bool streaming = false;
  std::size_t open = 0;  ///< file descriptors
  std::size_t in_flight = 0;
};

class UsbScanner {
 public:
  explicit UsbScanner(const Testbed& bed, std::string serial = "A1");
  ~UsbScanner();
  UsbScanner(const UsbScanner&) = delete;
  UsbScanner& operator=(const UsbScanner&) = delete;

  /// It comes, as a device of the next address. `announce` = udev tells of it.
  void plug(bool announce = true);
  void unplug(bool announce = true);
  /// Once more what udev told when it came.
  void announce_again();

  /// One transfer each: bytes (none: a zero-length packet) and the status of the URB, 0 or −errno. They wait until
  /// streaming is on; −EPIPE halts the endpoint until CLEAR_HALT.
  void answer(const Bytes& bytes, int status = 0);
  /// In transfers of at most `piece` bytes.
  void send(const Bytes& bytes, std::size_t piece = 16'384);

  ScannerState state() const;
  template <class Change>
  void change(Change change) {
    const std::lock_guard lock(mutex_);
    change(state_);
  }
  std::string node() const;  ///< /dev/bus/usb/001/…

 private:
  struct Answer {
    Bytes bytes;
    int status = 0;
  };
  static gboolean on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, void* self);
  long handle(unsigned long request, void* argument);
  long claim();
  long submit(usbdevfs_urb* urb);
  long reap(void* argument);
  long discard(const void* urb);
  void control(usbdevfs_urb* urb);
  void serve();
  void finish(usbdevfs_urb* urb, int status);

  const Testbed& bed_;
  std::string serial_;
  UMockdevIoctlBase* base_ = nullptr;
  std::string syspath_;
  int address_ = 1;
  mutable std::mutex mutex_;
  ScannerState state_;
  bool gone_ = true;
  bool halted_ = false;
  std::deque<Answer> answers_;
  std::deque<usbdevfs_urb*> waiting_, done_;
};

}  // namespace scree::test
