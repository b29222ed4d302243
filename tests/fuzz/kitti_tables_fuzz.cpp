// Any text: the readers of a KITTI sequence's times, poses and calibration accept or refuse; accepted times increase,
// accepted transforms are rigid and finite, and a refusal names its file.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "drivers/kitti_tables.hpp"
#include "drivers/table.hpp"

namespace {

using namespace scree;
using namespace scree::drivers;

void expect(bool condition) {
  if (!condition) std::abort();
}

template <class T>
bool taken(const Result<T>& result) {
  expect(result || (result.error().kind == ErrorKind::bad_data && result.error().message.starts_with("fuzz:")));
  return static_cast<bool>(result);
}

void check_pose(const Pose& pose) {
  expect(pose.translation_m.cwiseAbs().maxCoeff() < kTableMaxCoordinate_m);
  expect(std::abs(pose.rotation.norm() - 1.0) < 1e-9);
}

void check(std::string_view text) {
  if (const auto times = parse_kitti_times(text, "fuzz"); taken(times))
    for (std::size_t i = 0; i < times->size(); ++i) {
      expect(std::abs(to_seconds((*times)[i].time_since_epoch())) <= kTableMaxSeconds);
      expect(i == 0 || (*times)[i] > (*times)[i - 1]);
    }
  if (const auto poses = parse_kitti_poses(text, "fuzz"); taken(poses))
    for (const Pose& pose : *poses) check_pose(pose);
  if (const auto calibration = parse_kitti_calibration(text, "fuzz"); taken(calibration)) check_pose(*calibration);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check(text);
  check("Tr: " + std::string(text));                               // a calibration is reached at once
  check("1 0 0 0 0 1 0 0 0 0 1 0\n" + std::string(text) + "\n0");  // and so are later poses
  return 0;
}
