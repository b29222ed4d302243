// Any text: the readers of frames.csv and poses.csv accept or refuse; accepted rows have increasing times, stay in
// their folder, and survive writing and reading.

#include <cstdint>
#include <cstdlib>
#include <string>

#include "drivers/table.hpp"

namespace {

using namespace scree::drivers;

void check_frames(std::string_view text) {
  const auto rows = parse_frames_table(text, "fuzz");
  if (!rows) return;
  std::string written = std::string(kFramesHeader) + "\n";
  for (const FrameRow& row : *rows) {
    if (!row.file.starts_with("frames/") || row.file.find("..") == 0) std::abort();
    written += format_frame_row(row);
  }
  const auto back = parse_frames_table(written, "fuzz");
  if (!back || back->size() != rows->size()) std::abort();
  for (std::size_t i = 0; i < rows->size(); ++i)
    if ((*back)[i].time != (*rows)[i].time || (*back)[i].sequence != (*rows)[i].sequence) std::abort();
}

void check_poses(std::string_view text) {
  const auto poses = parse_poses_table(text, "fuzz");
  if (!poses) return;
  std::string written = std::string(kPosesHeader) + "\n";
  for (const auto& pose : *poses) written += format_pose_row(pose);
  const auto back = parse_poses_table(written, "fuzz");
  if (!back || back->size() != poses->size()) std::abort();
  for (std::size_t i = 0; i < poses->size(); ++i)
    if ((*back)[i].T_map_body.translation_m != (*poses)[i].T_map_body.translation_m) std::abort();
  if (!scree::PoseTrack::make(*poses)) std::abort();  // the table's rules are the track's
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check_frames(text);
  check_poses(text);
  // Behind a good header the rows are reached at once.
  check_frames(std::string(kFramesHeader) + "\n" + std::string(text));
  check_poses(std::string(kPosesHeader) + "\n" + std::string(text));
  return 0;
}
