#include "tests/devices/usb_scanner.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <thread>

namespace scree::test {
namespace {

namespace usb = drivers::usb;

/// A camera's interface first, as in a composite device: the scanner's is number 1.
Bytes descriptors(std::uint8_t protocol, std::uint8_t endpoint_type) {
  Bytes out{18,
            1,
            0x00,
            0x02,
            0xEF,
            2,
            1,
            64,
            usb::kVendorId & 0xFF,
            usb::kVendorId >> 8,
            usb::kProductId & 0xFF,
            usb::kProductId >> 8,
            0x00,
            0x01,
            0,
            0,
            0,
            1};
  const Bytes configuration{9, 2, 34, 0, 2, 1, 0, 0x80, 50};
  const Bytes camera{9, 4, 0, 0, 0, 0x0E, 1, 0, 0};
  const Bytes scanner{9, 4, 1, 0, 1, usb::kInterfaceClass, usb::kInterfaceSubclass, protocol, 0};
  const Bytes endpoint{7, 5, usb::kFrameEndpoint, endpoint_type, 0x00, 0x02, 0};
  for (const Bytes* part : {&configuration, &camera, &scanner, &endpoint})
    out.insert(out.end(), part->begin(), part->end());
  return out;
}

}  // namespace

UsbScanner::UsbScanner(const Testbed& bed, std::string serial) : bed_(bed), serial_(std::move(serial)) {
  base_ = umockdev_ioctl_base_new();
  g_signal_connect(base_, "handle-ioctl", G_CALLBACK(&UsbScanner::on_ioctl), this);
}

UsbScanner::~UsbScanner() {
  if (!gone_) unplug();
  g_object_unref(base_);
}

std::string UsbScanner::node() const {
  return fmt::format("/dev/bus/usb/001/{:03}", address_);
}

void UsbScanner::plug(bool announce) {
  {
    const std::lock_guard lock(mutex_);
    address_ = address_ % 100 + 2;
    gone_ = halted_ = false;
    state_.streaming = false;
    answers_.clear();
  }
  const auto file = std::filesystem::path(bed_.root() + node());
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file).flush();
  const std::string address = std::to_string(address_), long_address = fmt::format("{:03}", address_);
  gchar* path = umockdev_testbed_add_device(
      bed_.get(), "usb", "1-1", nullptr,  //
      "busnum", "1", "devnum", address.c_str(), "bConfigurationValue", "1", "speed", "480", "product", "Test scanner",
      "serial", serial_.c_str(), "idVendor", "1209", "idProduct", "0001", nullptr,  //
      "DEVTYPE", "usb_device", "DEVNAME", node().c_str(), "BUSNUM", "001", "DEVNUM", long_address.c_str(), nullptr);
  ASSERT_NE(path, nullptr);
  syspath_ = path;
  g_free(path);
  Bytes bytes = descriptors(state_.protocol, state_.endpoint_type);
  umockdev_testbed_set_attribute_binary(bed_.get(), syspath_.c_str(), "descriptors", bytes.data(),
                                        static_cast<gint>(bytes.size()));
  GError* error = nullptr;
  ASSERT_TRUE(umockdev_testbed_attach_ioctl(bed_.get(), node().c_str(), base_, &error)) << error->message;
  if (announce) umockdev_testbed_uevent(bed_.get(), syspath_.c_str(), "add");
}

void UsbScanner::announce_again() {
  umockdev_testbed_uevent(bed_.get(), syspath_.c_str(), "add");
}

void UsbScanner::unplug(bool announce) {
  {
    const std::lock_guard lock(mutex_);
    gone_ = true;
    while (!waiting_.empty()) {
      finish(waiting_.front(), state_.unplug_status);
      waiting_.pop_front();
    }
  }
  if (announce) umockdev_testbed_uevent(bed_.get(), syspath_.c_str(), "remove");
  umockdev_testbed_detach_ioctl(bed_.get(), node().c_str(), nullptr);
  umockdev_testbed_remove_device(bed_.get(), syspath_.c_str());
  std::filesystem::remove(bed_.root() + node());
  const std::lock_guard lock(mutex_);
  state_.claims = 0;
}

void UsbScanner::answer(const Bytes& bytes, int status) {
  const std::lock_guard lock(mutex_);
  answers_.push_back({bytes, status});
  serve();
}

void UsbScanner::send(const Bytes& bytes, std::size_t piece) {
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    answer({first, first + static_cast<std::ptrdiff_t>(std::min(piece, bytes.size() - at))});
  }
}

ScannerState UsbScanner::state() const {
  const std::lock_guard lock(mutex_);
  ScannerState out = state_;
  out.in_flight = waiting_.size() + done_.size();
  return out;
}

gboolean UsbScanner::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* self) {
  void* argument = nullptr;
  std::memcpy(&argument, umockdev_ioctl_client_get_arg(client)->data, sizeof(argument));
  const long result = static_cast<UsbScanner*>(self)->handle(umockdev_ioctl_client_get_request(client), argument);
  if (result == -EAGAIN)
    std::this_thread::sleep_for(std::chrono::microseconds(100));  // poll() finds the file ready always
  umockdev_ioctl_client_complete(client, result < 0 ? -1 : result, result < 0 ? static_cast<gint>(-result) : 0);
  return TRUE;
}

long UsbScanner::handle(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  switch (request) {
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      return reap(argument);
    case USBDEVFS_DISCARDURB:
      return discard(argument);
    default:
      if (gone_) return -ENODEV;
  }
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                               USBDEVFS_CAP_BULK_SCATTER_GATHER | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      return 0;
    case USBDEVFS_CLAIMINTERFACE:
      return claim();
    case USBDEVFS_RELEASEINTERFACE:
      state_.claims = 0;
      waiting_.clear();  // the kernel kills what is in flight; nobody asks for it between this and closing
      return 0;
    case USBDEVFS_CLEAR_HALT:
      ++state_.clear_halts;
      halted_ = false;
      serve();
      return 0;
    case USBDEVFS_RESET:
      ++state_.resets;
      return 0;
    case USBDEVFS_SUBMITURB:
      return submit(static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_IOCTL:
      return -ENODATA;  // no kernel driver is bound
    default:
      return -ENOTTY;
  }
}

long UsbScanner::claim() {
  if (state_.claim_error != 0) return -state_.claim_error;
  if (state_.claims > 0) return -EBUSY;
  ++state_.claims;
  return 0;
}

long UsbScanner::submit(usbdevfs_urb* urb) {
  if (urb->type == USBDEVFS_URB_TYPE_CONTROL) {
    control(urb);
    return 0;
  }
  if (state_.submit_error != 0) return -state_.submit_error;
  if (urb->type != USBDEVFS_URB_TYPE_BULK || urb->endpoint != usb::kFrameEndpoint) return -ENOENT;
  ++state_.submits;
  waiting_.push_back(urb);
  serve();
  return 0;
}

void UsbScanner::control(usbdevfs_urb* urb) {
  const auto* setup = static_cast<const std::uint8_t*>(urb->buffer);
  const auto request = static_cast<usb::Request>(setup[1]);
  const bool to_scanner = setup[4] == 1 && (setup[0] == 0xC1 || setup[0] == 0x41);
  urb->actual_length = 0;
  if (to_scanner && request == usb::Request::get_info && setup[0] == 0xC1) {
    const std::size_t length = std::min<std::size_t>(setup[6], state_.info.size());
    std::memcpy(static_cast<std::uint8_t*>(urb->buffer) + 8, state_.info.data(), length);
    urb->actual_length = static_cast<int>(length);
    finish(urb, 0);
  } else if (to_scanner && request == usb::Request::set_streaming && setup[0] == 0x41) {
    state_.streaming = setup[2] == 1;
    ++(state_.streaming ? state_.streaming_on : state_.streaming_off);
    finish(urb, 0);
    serve();
  } else {
    finish(urb, -EPIPE);
  }
}

void UsbScanner::serve() {
  if (!state_.streaming || (state_.sends_after_restart && state_.streaming_off == 0)) return;
  while (!halted_ && !waiting_.empty() && !answers_.empty()) {
    usbdevfs_urb* const urb = waiting_.front();
    waiting_.pop_front();
    const Answer answer = std::move(answers_.front());
    answers_.pop_front();
    const auto room = static_cast<std::size_t>(urb->buffer_length);
    const std::size_t length = std::min(answer.bytes.size(), room);
    if (length > 0) std::memcpy(urb->buffer, answer.bytes.data(), length);
    urb->actual_length = static_cast<int>(length);
    halted_ = answer.status == -EPIPE;
    finish(urb, answer.bytes.size() > room ? -EOVERFLOW : answer.status);
  }
}

void UsbScanner::finish(usbdevfs_urb* urb, int status) {
  urb->status = status;
  done_.push_back(urb);
}

long UsbScanner::reap(void* argument) {
  if (done_.empty()) return gone_ ? -ENODEV : -EAGAIN;
  *static_cast<usbdevfs_urb**>(argument) = done_.front();
  done_.pop_front();
  return 0;
}

long UsbScanner::discard(const void* urb) {
  const auto found = std::find(waiting_.begin(), waiting_.end(), urb);
  if (found == waiting_.end()) return gone_ ? -ENODEV : -EINVAL;
  if (state_.keeps_transfers) return 0;
  (*found)->actual_length = 0;
  finish(*found, -ENOENT);
  waiting_.erase(found);
  return 0;
}

}  // namespace scree::test
