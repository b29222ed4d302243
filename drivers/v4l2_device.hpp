#pragma once
// A V4L2 device that captures range images into buffers that it shares with us: negotiation, start, buffers.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/result.hpp"
#include "core/time.hpp"
#include "drivers/v4l2_capabilities.hpp"
#include "drivers/v4l2_handle.hpp"
#include "drivers/v4l2_image.hpp"

namespace scree::drivers::v4l2 {

/// What is wanted of a device.
struct Wanted {
  const RangeFormat* format = nullptr;  ///< null = the first of kRangeFormats that it offers
  int rows = 0, columns = 0;            ///< 0 = as the device has it
  double rate_hz = 0.0;                 ///< 0 = as the device has it
};

/// A filled buffer; its bytes are the device's again after Device::give_back.
struct Buffer {
  std::uint32_t index = 0;
  std::uint32_t sequence = 0;
  bool flagged = false;       ///< the driver says that the data may be corrupt
  bool monotonic = false;     ///< `stamp` is of the monotonic clock; otherwise it says nothing
  bool end_of_frame = false;  ///< `stamp` is of the last pixel, not of the first
  MonotonicTime stamp;
  std::span<const std::uint8_t> bytes;  ///< what the device filled in, padding included
};

/// Captures from open() to its destruction; nothing of it outlives that. One thread.
class Device {
 public:
  Device(Device&&) = default;
  Device& operator=(Device&&) = delete;
  ~Device();

  /// Opens, negotiates, maps four buffers and starts. Errors: no_input where there is no such device; unavailable where
  /// it refuses: path, expected, found, and what the device offers. Cost: some 20 … 200 ioctls and what the hardware
  /// takes to start.
  static Result<Device> open(const std::string& path, const Wanted& wanted);

  const Image& image() const { return image_; }
  const std::string& card() const { return capabilities_.card; }
  /// Where the device gives something else than was asked for and can be lived with; mostly empty.
  const std::string& remark() const { return remark_; }

  /// The oldest filled buffer, waited for at most `timeout`. An Error means that the device is lost.
  Result<std::optional<Buffer>> take(std::chrono::milliseconds timeout);
  Status give_back(const Buffer& buffer);

 private:
  /// One buffer in our address space, for reading.
  class Mapping {
   public:
    static Result<Mapping> of(const Handle& handle, const std::string& path, std::int64_t offset, std::size_t length);
    Mapping(Mapping&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
    Mapping& operator=(Mapping&&) = delete;
    ~Mapping();
    std::span<const std::uint8_t> bytes() const { return bytes_; }

   private:
    explicit Mapping(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
    std::span<const std::uint8_t> bytes_;
  };

  Device(Handle handle, std::string path, Capabilities capabilities)
      : handle_(std::move(handle)), path_(std::move(path)), capabilities_(std::move(capabilities)) {}
  Status set_format(const Wanted& wanted);
  void set_rate(double wanted_hz);
  Status map_buffers();
  Status queue(std::uint32_t index);
  Error refused(const std::string& expected, const std::string& found) const;

  Handle handle_;
  std::string path_;
  Capabilities capabilities_;
  Image image_;
  std::string remark_;
  std::vector<Mapping> mappings_;  ///< go before the descriptor does
  bool started_ = false;
};

}  // namespace scree::drivers::v4l2
