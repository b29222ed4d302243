#include "drivers/usb_link.hpp"

#include <array>
#include <fmt/format.h>
#include <libusb.h>

#include "core/time.hpp"
#include "drivers/frame_stream.hpp"
#include "drivers/little_endian.hpp"

namespace scree::drivers::usb {
namespace {

constexpr std::uint8_t kVendorInterface =
    std::uint8_t{LIBUSB_REQUEST_TYPE_VENDOR} | std::uint8_t{LIBUSB_RECIPIENT_INTERFACE};
constexpr std::uint8_t kIn = std::uint8_t{LIBUSB_ENDPOINT_IN} | kVendorInterface;
constexpr std::uint8_t kOut = std::uint8_t{LIBUSB_ENDPOINT_OUT} | kVendorInterface;
static_assert(kIn == 0xC1 && kOut == 0x41, "as docs/usb-protocol.md has them");

}  // namespace

Result<Info> judge_info(std::span<const std::uint8_t> answer) {
  if (answer.size() != kInfoBytes)
    return Error{ErrorKind::bad_data, fmt::format("GET_INFO: expected {} bytes, found {}", kInfoBytes, answer.size())};
  ByteReader in(answer);
  Info info;
  info.major = in.take<std::uint8_t>();
  info.minor = in.take<std::uint8_t>();
  in.skip(2);
  info.largest_message = in.take<std::uint32_t>();
  if (info.major != stream::kVersionMajor)
    return Error{ErrorKind::bad_data,
                 fmt::format("GET_INFO: expected major version {} of the frame stream, found {}.{}",
                             stream::kVersionMajor, info.major, info.minor)};
  return info;
}

Result<std::unique_ptr<Link>> Link::open(Context& context, const DeviceRef& device) {
  std::unique_ptr<Link> link(new Link(context, device));
  const auto interface = find_interface(device.get());
  if (!interface) return interface.error();
  link->interface_ = *interface;
  if (const int code = libusb_open(device.get(), &link->handle_); code != 0) {
    link->handle_ = nullptr;
    return link->failed("open", code);
  }
  context.watch(device.get());
  if (auto status = link->claim(); !status) return status.error();
  if (auto status = link->check_info(); !status) return status.error();
  auto transfers = Transfers::make(link->handle_, *interface);
  if (!transfers) return transfers.error();
  link->transfers_ = *std::move(transfers);
  if (auto status = link->resume(); !status) return status.error();
  if (auto status = link->set_streaming(true); !status) return status.error();
  return link;
}

Link::~Link() {
  if (handle_ == nullptr) return;
  if (claimed_ && !gone_) (void)set_streaming(false);
  if (transfers_) (void)drain();
  if (claimed_) libusb_release_interface(handle_, interface_.number);
  context_.watch(nullptr);
  libusb_close(handle_);  // before the transfers go: the kernel lets go of those that did not come back
}

Status Link::claim() {
  libusb_set_auto_detach_kernel_driver(handle_, 1);  // "not supported" is as good: then nothing holds it
  if (const int code = libusb_claim_interface(handle_, interface_.number); code != 0) return failed("claim", code);
  claimed_ = true;
  if (interface_.alternate == 0) return {};
  const int code = libusb_set_interface_alt_setting(handle_, interface_.number, interface_.alternate);
  return code == 0 ? Status() : failed("alternate setting", code);
}

Status Link::check_info() {
  std::array<std::uint8_t, kInfoBytes> answer{};
  const int got = libusb_control_transfer(handle_, kIn, static_cast<std::uint8_t>(Request::get_info), 0,
                                          static_cast<std::uint16_t>(interface_.number), answer.data(), kInfoBytes,
                                          static_cast<unsigned>(kControlTimeout.count()));
  if (got < 0) return failed("GET_INFO", got);
  const auto info = judge_info(std::span(answer).first(static_cast<std::size_t>(got)));
  return info ? Status() : info.error();
}

Status Link::set_streaming(bool on) {
  const int code = libusb_control_transfer(handle_, kOut, static_cast<std::uint8_t>(Request::set_streaming), on ? 1 : 0,
                                           static_cast<std::uint16_t>(interface_.number), nullptr, 0,
                                           static_cast<unsigned>(kControlTimeout.count()));
  return code < 0 ? failed(on ? "SET_STREAMING 1" : "SET_STREAMING 0", code) : Status();
}

/// Whether all transfers are back.
bool Link::drain() {
  transfers_->cancel();
  const MonotonicTime limit = MonotonicClock::now() + kDrainTimeout;
  while (transfers_->in_flight() > 0) {
    const auto left = std::chrono::floor<std::chrono::milliseconds>(limit - MonotonicClock::now());
    if (left.count() <= 0) return false;
    context_.handle_events(left);
  }
  transfers_->discard();
  return true;
}

Status Link::clear_halt() {
  const int code = libusb_clear_halt(handle_, interface_.endpoint);
  return code == 0 ? Status() : failed("clear halt", code);
}

Status Link::submit() {
  const int code = transfers_->submit();
  return code == 0 ? Status() : failed("submit a transfer", code);
}

Status Link::resume() {
  if (auto status = clear_halt(); !status) return status;
  return submit();
}

Status Link::restart_stream() {
  if (auto status = set_streaming(false); !status) return status;
  if (!drain())
    return Error{ErrorKind::unavailable, fmt::format("expected all cancelled transfers back within {} ms, found {} not",
                                                     kDrainTimeout.count(), transfers_->in_flight())};
  if (auto status = resume(); !status) return status;
  return set_streaming(true);
}

void Link::reset() {
  (void)drain();
  (void)libusb_reset_device(handle_);
}

Error Link::failed(const char* what, int code) {
  if (code == LIBUSB_ERROR_NO_DEVICE || code == LIBUSB_ERROR_NOT_FOUND) gone_ = true;
  return {ErrorKind::unavailable, failure(address_of(device_.get()), interface_.number, what, code)};
}

}  // namespace scree::drivers::usb
