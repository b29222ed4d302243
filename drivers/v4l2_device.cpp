#include "drivers/v4l2_device.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <thread>

namespace scree::drivers::v4l2 {
namespace {

constexpr std::uint32_t kBuffers = 4;
constexpr std::uint32_t kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr std::chrono::milliseconds kSpuriousWake{1};
constexpr double kSameRate = 0.01;  ///< 29.97 is 30

std::string image_text(const std::string& format, std::uint32_t columns, std::uint32_t rows) {
  return fmt::format("{} {} x {}", format, columns, rows);
}

v4l2_buffer mapped_buffer(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.index = index;
  buffer.type = kCapture;
  buffer.memory = V4L2_MEMORY_MMAP;
  return buffer;
}

}  // namespace

Result<Device::Mapping> Device::Mapping::of(const Handle& handle, const std::string& path, std::int64_t offset,
                                            std::size_t length) {
  void* at = ::mmap(nullptr, length, PROT_READ, MAP_SHARED, handle.descriptor(), offset);
  if (at == MAP_FAILED) return call_error(path, "mmap", errno);
  return Mapping({static_cast<const std::uint8_t*>(at), length});
}

Device::Mapping::~Mapping() {
  if (!bytes_.empty()) ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

Device::~Device() {
  int type = kCapture;
  if (started_ && handle_.descriptor() >= 0) (void)handle_.control(VIDIOC_STREAMOFF, &type);  // gone, perhaps
}

Result<Device> Device::open(const std::string& path, const Wanted& wanted) {
  auto handle = Handle::open(path);
  if (!handle) return handle.error();
  auto capabilities = read_capabilities(*handle, path);
  if (!capabilities) return capabilities.error();
  if (const std::string why = why_unusable(*capabilities); !why.empty())
    return Error{ErrorKind::unavailable, fmt::format("'{}' ({}): {}", path, capabilities->card, why)};
  Device device(*std::move(handle), path, *std::move(capabilities));
  if (auto set = device.set_format(wanted); !set) return set.error();
  device.set_rate(wanted.rate_hz);
  if (auto mapped = device.map_buffers(); !mapped) return mapped.error();
  int type = kCapture;
  if (const int error = device.handle_.control(VIDIOC_STREAMON, &type); error != 0)
    return call_error(path, "VIDIOC_STREAMON", error);
  device.started_ = true;
  return device;
}

Error Device::refused(const std::string& expected, const std::string& found) const {
  return {ErrorKind::unavailable, fmt::format("'{}' ({}): expected {}, found {}; the device offers {}", path_,
                                              capabilities_.card, expected, found, offers_text(capabilities_.formats))};
}

Status Device::set_format(const Wanted& wanted) {
  std::vector<std::uint32_t> offered;
  for (const FormatOffer& format : capabilities_.formats) offered.push_back(format.fourcc);
  const RangeFormat* chosen = choose_format(wanted.format, offered);
  if (!chosen) return refused(wanted.format ? wanted.format->name : kRangeFormatNames, "a device without it");

  v4l2_format format{};
  format.type = kCapture;
  if (const int error = handle_.control(VIDIOC_G_FMT, &format); error != 0)
    return call_error(path_, "VIDIOC_G_FMT", error);
  v4l2_pix_format& image = format.fmt.pix;
  const std::uint32_t columns = wanted.columns > 0 ? static_cast<std::uint32_t>(wanted.columns) : image.width;
  const std::uint32_t rows = wanted.rows > 0 ? static_cast<std::uint32_t>(wanted.rows) : image.height;
  image = {};
  image.width = columns;
  image.height = rows;
  image.pixelformat = chosen->fourcc;
  image.field = V4L2_FIELD_NONE;
  if (const int error = handle_.control(VIDIOC_S_FMT, &format); error == EINVAL)
    return refused(image_text(chosen->name, columns, rows), "a refusal");
  else if (error != 0)
    return call_error(path_, "VIDIOC_S_FMT", error);

  if (image.pixelformat != chosen->fourcc || (wanted.columns > 0 && image.width != columns) ||
      (wanted.rows > 0 && image.height != rows))
    return refused(image_text(chosen->name, columns, rows),
                   image_text(fourcc_text(image.pixelformat), image.width, image.height));
  if (image.width < 1 || image.height < 1 || image.width > 16384 || image.height > 16384)
    return refused("an image of 1 … 16384 columns and rows", fmt::format("{} x {}", image.width, image.height));
  if (image.field != V4L2_FIELD_NONE && image.field != V4L2_FIELD_ANY)
    return refused("whole frames", fmt::format("interlaced ones (field {})", image.field));
  const std::uint32_t line = image.bytesperline > 0 ? image.bytesperline : 2 * image.width;
  if (line < 2 * image.width)
    return refused(fmt::format("{} bytes a row or more", 2 * image.width), fmt::to_string(line));
  image_ = {chosen, static_cast<int>(image.height), static_cast<int>(image.width), line, 0.0};
  return {};
}

/// Another rate than the wanted one is said and lived with: the frames are good.
void Device::set_rate(double wanted_hz) {
  v4l2_streamparm parameters{};
  parameters.type = kCapture;
  v4l2_captureparm& capture = parameters.parm.capture;
  const bool told = handle_.control(VIDIOC_G_PARM, &parameters) == 0;
  const bool can_set = told && (capture.capability & V4L2_CAP_TIMEPERFRAME) != 0;
  int error = 0;
  if (wanted_hz > 0.0 && can_set) {
    capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(1000.0 * wanted_hz))};
    error = handle_.control(VIDIOC_S_PARM, &parameters);
  }
  const v4l2_fract& interval = capture.timeperframe;
  if (can_set && error == 0 && interval.numerator > 0)
    image_.rate_hz = static_cast<double>(interval.denominator) / interval.numerator;
  if (wanted_hz <= 0.0 || std::abs(image_.rate_hz - wanted_hz) <= kSameRate * wanted_hz) return;
  std::string found = "a device whose rate cannot be set";
  if (error != 0) found = fmt::format("error {} of VIDIOC_S_PARM", error);
  if (image_.rate_hz > 0.0) found = fmt::format("{:.4g} Hz", image_.rate_hz);
  remark_ = fmt::format("rate: expected {:.4g} Hz, found {}", wanted_hz, found);
}

Status Device::map_buffers() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = kCapture;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = handle_.control(VIDIOC_REQBUFS, &request); error != 0)
    return call_error(path_, "VIDIOC_REQBUFS", error);
  if (request.count < 2) return refused("2 buffers or more", fmt::to_string(request.count));
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = mapped_buffer(i);
    if (const int error = handle_.control(VIDIOC_QUERYBUF, &buffer); error != 0)
      return call_error(path_, "VIDIOC_QUERYBUF", error);
    if (buffer.length < image_.bytes())
      return refused(fmt::format("buffers of {} bytes or more", image_.bytes()), fmt::to_string(buffer.length));
    auto mapping = Mapping::of(handle_, path_, buffer.m.offset, buffer.length);
    if (!mapping) return mapping.error();
    mappings_.push_back(*std::move(mapping));
    if (auto queued = queue(i); !queued) return queued;
  }
  return {};
}

Status Device::queue(std::uint32_t index) {
  v4l2_buffer buffer = mapped_buffer(index);
  const int error = handle_.control(VIDIOC_QBUF, &buffer);
  return error == 0 ? Status{} : call_error(path_, "VIDIOC_QBUF", error);
}

Result<std::optional<Buffer>> Device::take(std::chrono::milliseconds timeout) {
  const auto [ready, failed] = handle_.wait(timeout);
  if (!ready && !failed) return std::optional<Buffer>();
  v4l2_buffer filled = mapped_buffer(0);
  const int error = handle_.control(VIDIOC_DQBUF, &filled);
  if (error == EAGAIN) {
    if (failed) return call_error(path_, "poll", EIO);
    std::this_thread::sleep_for(kSpuriousWake);  // a driver that wakes us for nothing must not take the whole core
    return std::optional<Buffer>();
  }
  if (error != 0) return call_error(path_, "VIDIOC_DQBUF", error);
  if (filled.index >= mappings_.size())
    return Error{ErrorKind::unavailable, fmt::format("'{}': VIDIOC_DQBUF: expected a buffer of 0 … {}, found {}", path_,
                                                     mappings_.size() - 1, filled.index)};
  const auto whole = mappings_[filled.index].bytes();
  const Duration stamp =
      std::chrono::seconds(filled.timestamp.tv_sec) + std::chrono::microseconds(filled.timestamp.tv_usec);
  return std::optional(Buffer{
      .index = filled.index,
      .sequence = filled.sequence,
      .flagged = (filled.flags & V4L2_BUF_FLAG_ERROR) != 0,
      .monotonic = (filled.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC,
      .end_of_frame = (filled.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_EOF,
      .stamp = MonotonicTime(stamp),
      .bytes = whole.first(std::min<std::size_t>(filled.bytesused, whole.size())),
  });
}

Status Device::give_back(const Buffer& buffer) {
  return queue(buffer.index);
}

}  // namespace scree::drivers::v4l2
