// Smoke layer of the hardware-in-the-loop test: the Z16 images of the simulated scanner through V4L2, counted.
// probe_v4l2 DEVICE SECONDS prints the format and "v4l2 frames N errors E".
#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char** argv) {
  const double seconds = argc > 2 ? atof(argv[2]) : 3.0;
  const int fd = open(argc > 1 ? argv[1] : "/dev/video0", O_RDWR | O_NONBLOCK);
  if (fd < 0) return perror("v4l2 open"), 1;
  struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
  if (ioctl(fd, VIDIOC_G_FMT, &format) != 0) return perror("v4l2 G_FMT"), 1;
  printf("v4l2 format %.4s %u x %u stride %u size %u\n", (const char*)&format.fmt.pix.pixelformat, format.fmt.pix.width,
         format.fmt.pix.height, format.fmt.pix.bytesperline, format.fmt.pix.sizeimage);
  struct v4l2_requestbuffers request = {.count = 4, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
  if (ioctl(fd, VIDIOC_REQBUFS, &request) != 0) return perror("v4l2 REQBUFS"), 1;
  void* map[8];
  for (unsigned i = 0; i < request.count; ++i) {
    struct v4l2_buffer b = {.index = i, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
    ioctl(fd, VIDIOC_QUERYBUF, &b);
    map[i] = mmap(NULL, b.length, PROT_READ, MAP_SHARED, fd, b.m.offset);
    ioctl(fd, VIDIOC_QBUF, &b);
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (ioctl(fd, VIDIOC_STREAMON, &type) != 0) return perror("v4l2 STREAMON"), 1;
  long frames = 0, errors = 0, first = -1, last = -1, mean = 0;
  const double start = now_s();
  while (now_s() < start + seconds) {
    struct pollfd waiting = {fd, POLLIN, 0};
    poll(&waiting, 1, 200);
    struct v4l2_buffer b = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
    if (ioctl(fd, VIDIOC_DQBUF, &b) != 0) continue;
    if ((b.flags & V4L2_BUF_FLAG_ERROR) != 0) ++errors;
    if (first < 0) first = b.sequence;
    last = b.sequence;
    const unsigned short* counts = map[b.index];
    mean = 0;
    for (unsigned i = 0; i < format.fmt.pix.sizeimage / 2; ++i) mean += counts[i];
    mean /= (long)(format.fmt.pix.sizeimage / 2);
    ++frames;
    ioctl(fd, VIDIOC_QBUF, &b);
  }
  printf("v4l2 frames %ld errors %ld sequence %ld..%ld mean_count %ld per_s %.1f\n", frames, errors, first, last, mean,
         (double)frames / (now_s() - start));
  return frames > 0 ? 0 : 1;
}
