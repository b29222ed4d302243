#include "tests/devices/v4l2_camera.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace scree::test {
namespace {

constexpr std::uint32_t kBuffers = 4;
constexpr std::uint32_t kSpan = 1U << 16;  ///< of the file, per buffer

template <std::size_t n>
void say(std::uint8_t (&to)[n], const char* text) {
  std::strncpy(reinterpret_cast<char*>(to), text, n - 1);
}

}  // namespace

Camera::Camera(Testbed& bed, CameraSettings settings)
    : bed_(bed), settings_(std::move(settings)), node_(settings_.node), file_(bed.root() + "/dev/" + node_) {
  const int fd = ::open(file_.c_str(), O_RDWR | O_CREAT, 0600);
  if (fd < 0 || ::ftruncate(fd, kBuffers * kSpan) != 0) ADD_FAILURE() << file_ << ": " << std::strerror(errno);
  void* at = ::mmap(nullptr, kBuffers * kSpan, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (at == MAP_FAILED) ADD_FAILURE() << file_ << ": " << std::strerror(errno);
  ::close(fd);
  shared_ = static_cast<std::uint8_t*>(at);
  handler_.reset(umockdev_ioctl_base_new());
  g_signal_connect(handler_.get(), "handle-ioctl", G_CALLBACK(on_ioctl), this);
  EXPECT_TRUE(umockdev_testbed_attach_ioctl(bed_.get(), path().c_str(), handler_.get(), nullptr));
}

Camera::~Camera() {
  umockdev_testbed_detach_ioctl(bed_.get(), path().c_str(), nullptr);
  ::munmap(shared_, kBuffers * kSpan);
}

void Camera::deliver(Picture picture) {
  const std::lock_guard lock(mutex_);
  pictures_.push_back(std::move(picture));
}

void Camera::always(std::function<Picture(std::uint32_t)> make) {
  const std::lock_guard lock(mutex_);
  make_ = std::move(make);
}

void Camera::fail(unsigned long request, int error, int times) {
  const std::lock_guard lock(mutex_);
  faults_[request] = {error, times};
}

void Camera::set_plugged(bool plugged) {
  const std::lock_guard lock(mutex_);
  plugged_ = plugged;
}

void Camera::hide_node() {
  std::filesystem::rename(file_, file_ + "-hidden");
}

void Camera::show_node() {
  std::filesystem::rename(file_ + "-hidden", file_);
}

void Camera::change(const std::function<void(CameraSettings&)>& how) {
  const std::lock_guard lock(mutex_);
  how(settings_);
}

Camera::Counts Camera::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

gboolean Camera::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  const unsigned long request = umockdev_ioctl_client_get_request(client) & 0xFFFF'FFFFUL;
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, _IOC_SIZE(request), nullptr);
  std::vector<std::uint8_t> copy(data->data, data->data + data->data_len);
  const int error = static_cast<Camera*>(self)->answer(request, copy.data());
  if (error == 0) umockdev_ioctl_data_update(data, 0, copy.data(), static_cast<gint>(copy.size()));
  umockdev_ioctl_data_unref(data);
  umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
  return TRUE;
}

int Camera::answer(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  if (!plugged_) return ENODEV;
  if (const auto fault = faults_.find(request); fault != faults_.end() && fault->second.second != 0) {
    if (fault->second.second > 0) --fault->second.second;
    return fault->second.first;
  }
  for (const auto part : {&Camera::describe, &Camera::negotiate, &Camera::buffers})
    if (const int error = (this->*part)(request, argument); error != ENOTTY) return error;
  return ENOTTY;
}

int Camera::describe(unsigned long request, void* argument) {
  if (request == VIDIOC_QUERYCAP) {
    auto& out = *static_cast<v4l2_capability*>(argument);
    say(out.driver, "fake");
    say(out.card, "Fake Depth");
    say(out.bus_info, "usb-fake-1");
    out.device_caps = settings_.device_caps;
    out.capabilities = settings_.device_caps | V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    return 0;
  }
  if (request == VIDIOC_ENUM_FMT) {
    auto& out = *static_cast<v4l2_fmtdesc*>(argument);
    if (out.index >= settings_.formats.size()) return EINVAL;
    out.pixelformat = settings_.formats[out.index];
    say(out.description, "Depth");
    return 0;
  }
  if (request == VIDIOC_ENUM_FRAMESIZES) {
    auto& out = *static_cast<v4l2_frmsizeenum*>(argument);
    if (out.index > 0) return EINVAL;
    out.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    out.discrete = {settings_.columns, settings_.rows};
    return 0;
  }
  if (request == VIDIOC_ENUM_FRAMEINTERVALS) {
    auto& out = *static_cast<v4l2_frmivalenum*>(argument);
    if (out.index > 0) return EINVAL;
    out.type = V4L2_FRMIVAL_TYPE_DISCRETE;
    out.discrete = {1, settings_.rate_hz};
    return 0;
  }
  return ENOTTY;
}

int Camera::negotiate(unsigned long request, void* argument) {
  if (request == VIDIOC_G_FMT || request == VIDIOC_S_FMT) {
    auto& image = static_cast<v4l2_format*>(argument)->fmt.pix;
    bool offered = false;
    for (const std::uint32_t format : settings_.formats) offered = offered || format == image.pixelformat;
    const std::uint32_t chosen = request == VIDIOC_S_FMT && offered ? image.pixelformat : settings_.formats.front();
    image = {};
    image.width = settings_.columns;
    image.height = settings_.rows;
    image.pixelformat = chosen;
    image.field = V4L2_FIELD_NONE;
    image.bytesperline = line();
    image.sizeimage = line() * settings_.rows;
    return 0;
  }
  if (request == VIDIOC_G_PARM || request == VIDIOC_S_PARM) {
    auto& capture = static_cast<v4l2_streamparm*>(argument)->parm.capture;
    capture.capability = V4L2_CAP_TIMEPERFRAME;
    capture.timeperframe = {1, settings_.rate_hz};
    return 0;
  }
  return ENOTTY;
}

int Camera::buffers(unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_REQBUFS:
      static_cast<v4l2_requestbuffers*>(argument)->count = kBuffers;
      queued_.clear();
      return 0;
    case VIDIOC_QUERYBUF: {
      auto& out = *static_cast<v4l2_buffer*>(argument);
      if (out.index >= kBuffers) return EINVAL;
      out.length = line() * settings_.rows;
      out.m.offset = out.index * kSpan;
      return 0;
    }
    case VIDIOC_QBUF:
      queued_.push_back(static_cast<v4l2_buffer*>(argument)->index);
      return 0;
    case VIDIOC_STREAMON:
      if (queued_.empty()) return EINVAL;
      streaming_ = true;
      next_sequence_ = 0;
      ++counts_.started;
      return 0;
    case VIDIOC_STREAMOFF:
      streaming_ = false;
      queued_.clear();
      ++counts_.stopped;
      return 0;
    case VIDIOC_DQBUF:
      return take(argument);
    default:
      return ENOTTY;
  }
}

int Camera::take(void* argument) {
  if (!streaming_) return EINVAL;
  if (queued_.empty()) return EAGAIN;
  if (pictures_.empty() && make_) pictures_.push_back(make_(next_sequence_++));
  if (pictures_.empty()) return EAGAIN;
  const Picture picture = std::move(pictures_.front());
  pictures_.pop_front();
  auto& out = *static_cast<v4l2_buffer*>(argument);
  out.index = queued_.front();
  queued_.pop_front();
  std::uint8_t* at = shared_ + std::size_t{out.index} * kSpan;
  std::memset(at, 0xAB, kSpan);  // padding is anything
  for (std::uint32_t r = 0; r < settings_.rows && (r + 1) * settings_.columns <= picture.words.size(); ++r)
    std::memcpy(at + std::size_t{r} * line(), picture.words.data() + std::size_t{r} * settings_.columns,
                2 * settings_.columns);
  out.bytesused = picture.bytesused.value_or(line() * settings_.rows);
  out.sequence = picture.sequence;
  out.flags = (picture.flagged ? V4L2_BUF_FLAG_ERROR : 0U) |
              (picture.monotonic ? V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC : 0U) |
              (picture.start_of_exposure ? V4L2_BUF_FLAG_TSTAMP_SRC_SOE : 0U);
  const auto stamp = picture.stamp.value_or(MonotonicClock::now()).time_since_epoch();
  out.timestamp.tv_sec = std::chrono::duration_cast<std::chrono::seconds>(stamp).count();
  out.timestamp.tv_usec = std::chrono::duration_cast<std::chrono::microseconds>(stamp).count() % 1'000'000;
  return 0;
}

}  // namespace scree::test
