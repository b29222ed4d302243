// Drive commands of a simulated robot. An input is datagrams of 36 bytes; magic, version and CRC are repaired unless
// byte 5, which nobody reads, is odd.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "drivers/checksum.hpp"
#include "drivers/drive_command.hpp"
#include "drivers/little_endian.hpp"

namespace {

using namespace scree::drivers;

void expect(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  DriveReceiver receiver;
  std::uint64_t datagrams = 0;
  for (std::span<const std::uint8_t> input(data, size); !input.empty();) {
    std::vector<std::uint8_t> bytes(input.begin(),
                                    input.begin() + static_cast<std::ptrdiff_t>(std::min(input.size(), kDriveBytes)));
    input = input.subspan(bytes.size());
    if (bytes.size() == kDriveBytes && bytes[5] % 2 == 0) {
      std::copy(kDriveMagic.begin(), kDriveMagic.end(), bytes.begin());
      bytes[4] = kDriveVersion;
      ByteWriter(std::span(bytes).subspan(32)).put(crc32_of(std::span(bytes).first(32)));
    }
    ++datagrams;
    if (const auto command = receiver.accept(bytes)) {
      expect(std::abs(command->speed_mps) <= kMaxDriveSpeed_mps);
      expect(std::abs(command->curvature_per_m) <= kMaxDriveCurvature_per_m);
      expect(!receiver.accept(bytes));  // never twice
      ++datagrams;
    }
  }
  expect(receiver.accepted() + receiver.rejected() == datagrams);
  return 0;
}
