// Smoke layer of the hardware-in-the-loop test: the bulk frames of the simulated scanner through libusb, counted.
// probe_usb SECONDS prints "usb frames N bytes B first_t T".
#include <libusb-1.0/libusb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? atof(argv[1]) : 3.0;
  static unsigned char buffer[1 << 20], info[8];
  libusb_device_handle* device = NULL;
  if (libusb_init(NULL) != 0) return 1;
  const double begin = now_s();
  while (device == NULL && now_s() < begin + 10.0) {
    device = libusb_open_device_with_vid_pid(NULL, 0x1209, 0x0001);
    if (device == NULL) nanosleep(&(struct timespec){0, 50000000}, NULL);
  }
  if (device == NULL) return printf("usb none\n"), 1;
  int status = libusb_claim_interface(device, 0);
  if (status != 0) return printf("usb claim %s\n", libusb_error_name(status)), 1;
  status = libusb_control_transfer(device, 0xC1, 1, 0, 0, info, sizeof info, 1000);
  printf("usb info %d: version %d largest %u\n", status, info[0], info[4] | info[5] << 8 | info[6] << 16);
  status = libusb_control_transfer(device, 0x41, 2, 1, 0, NULL, 0, 1000);
  printf("usb set_streaming %d\n", status);
  long frames = 0, bytes = 0, bad = 0;
  const double start = now_s();
  while (now_s() < start + seconds) {
    int got = 0;
    status = libusb_bulk_transfer(device, 0x81, buffer, sizeof buffer, &got, 1000);
    if (status != 0) {
      printf("usb transfer %s %d\n", libusb_error_name(status), got);
      if (status == LIBUSB_ERROR_PIPE) libusb_clear_halt(device, 0x81);
      if (status == LIBUSB_ERROR_NO_DEVICE) break;
      continue;
    }
    if (got == 0) continue;
    if (memcmp(buffer, "SCF\xD3", 4) != 0) ++bad;
    ++frames;
    bytes += got;
  }
  printf("usb frames %ld bytes %ld bad %ld per_s %.1f\n", frames, bytes, bad, (double)frames / (now_s() - start));
  libusb_control_transfer(device, 0x41, 2, 0, 0, NULL, 0, 1000);
  libusb_close(device);
  return 0;
}
