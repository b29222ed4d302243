#include "drivers/v4l2_capabilities.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <linux/videodev2.h>

#include "drivers/v4l2_formats.hpp"

namespace scree::drivers::v4l2 {
namespace {

constexpr std::uint32_t kMost = 256;  ///< entries of a list: a driver that never says EINVAL must not hold us

template <std::size_t n>
std::string text(const std::uint8_t (&bytes)[n]) {
  const auto* begin = reinterpret_cast<const char*>(bytes);
  return {begin, strnlen(begin, n)};
}

/// Hz of a frame interval; 0 where it is none.
double rate(const v4l2_fract& interval) {
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator : 0.0;
}

void read_rates(const Handle& handle, std::uint32_t fourcc, FrameSize& size) {
  v4l2_frmivalenum asked{};
  asked.pixel_format = fourcc;
  asked.width = static_cast<std::uint32_t>(size.max_columns);
  asked.height = static_cast<std::uint32_t>(size.max_rows);
  for (; asked.index < kMost && handle.control(VIDIOC_ENUM_FRAMEINTERVALS, &asked) == 0; ++asked.index) {
    if (asked.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
      size.rates_hz.push_back(rate(asked.discrete));
      continue;
    }
    size.rates_hz = {rate(asked.stepwise.min), rate(asked.stepwise.max)};
    size.any_rate = true;
    break;
  }
  std::sort(size.rates_hz.rbegin(), size.rates_hz.rend());
}

std::vector<FrameSize> read_sizes(const Handle& handle, std::uint32_t fourcc) {
  std::vector<FrameSize> sizes;
  v4l2_frmsizeenum asked{};
  asked.pixel_format = fourcc;
  for (; asked.index < kMost && handle.control(VIDIOC_ENUM_FRAMESIZES, &asked) == 0; ++asked.index) {
    const bool discrete = asked.type == V4L2_FRMSIZE_TYPE_DISCRETE;
    const auto number = [](std::uint32_t value) { return static_cast<int>(value); };
    FrameSize size;
    size.columns = number(discrete ? asked.discrete.width : asked.stepwise.min_width);
    size.rows = number(discrete ? asked.discrete.height : asked.stepwise.min_height);
    size.max_columns = number(discrete ? asked.discrete.width : asked.stepwise.max_width);
    size.max_rows = number(discrete ? asked.discrete.height : asked.stepwise.max_height);
    read_rates(handle, fourcc, size);
    sizes.push_back(std::move(size));
    if (!discrete) break;
  }
  return sizes;
}

std::string size_text(const FrameSize& size) {
  std::string out = fmt::format("{} x {}", size.columns, size.rows);
  if (size.max_columns != size.columns || size.max_rows != size.rows)
    out += fmt::format(" … {} x {}", size.max_columns, size.max_rows);
  if (!size.rates_hz.empty())
    out += fmt::format(" at {:.4g} Hz", fmt::join(size.rates_hz, size.any_rate ? " … " : ", "));
  return out;
}

}  // namespace

Result<Capabilities> read_capabilities(const Handle& handle, const std::string& path) {
  v4l2_capability told{};
  if (const int error = handle.control(VIDIOC_QUERYCAP, &told); error == ENOTTY || error == EINVAL)
    return Error{ErrorKind::unavailable, fmt::format("'{}': expected a V4L2 device, found something else", path)};
  else if (error != 0)
    return call_error(path, "VIDIOC_QUERYCAP", error);
  // `capabilities` are those of all nodes of the device, `device_caps` those of this one
  const std::uint32_t can = (told.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? told.device_caps : told.capabilities;
  Capabilities out{text(told.driver), text(told.card), text(told.bus_info), false, false, {}};
  out.capture = (can & V4L2_CAP_VIDEO_CAPTURE) != 0;
  out.streaming = (can & V4L2_CAP_STREAMING) != 0;
  if (!out.capture) return out;
  v4l2_fmtdesc asked{};
  asked.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; asked.index < kMost && handle.control(VIDIOC_ENUM_FMT, &asked) == 0; ++asked.index)
    out.formats.push_back({asked.pixelformat, text(asked.description), read_sizes(handle, asked.pixelformat)});
  return out;
}

std::string offers_text(const std::vector<FormatOffer>& formats) {
  std::string out;
  for (const FormatOffer& format : formats) {
    if (!out.empty()) out += "; ";
    out += fourcc_text(format.fourcc);
    for (std::size_t i = 0; i < format.sizes.size(); ++i) out += (i > 0 ? ", " : " ") + size_text(format.sizes[i]);
  }
  return out.empty() ? "no formats" : out;
}

std::string why_unusable(const Capabilities& capabilities) {
  if (!capabilities.capture) return "expected video capture (single-planar), found a node without it";
  if (!capabilities.streaming) return "expected streaming I/O, found a device without it";
  const auto usable = [](const FormatOffer& format) { return range_format(format.fourcc) != nullptr; };
  if (std::any_of(capabilities.formats.begin(), capabilities.formats.end(), usable)) return {};
  return fmt::format("expected a range format ({}), found {}", kRangeFormatNames, offers_text(capabilities.formats));
}

}  // namespace scree::drivers::v4l2
