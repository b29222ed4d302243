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

void check_uncertain_poses(std::string_view text) {
  std::string torn;
  const auto table = parse_uncertain_poses_table(text, "fuzz", &torn);
  if (!table) return;
  if (!table->variances.empty() && table->variances.size() != table->poses.size()) std::abort();
  std::string written = std::string(kUncertainPosesHeader) + "\n";
  for (std::size_t i = 0; i < table->variances.size(); ++i)
    written += format_uncertain_pose_row(table->poses[i], table->variances[i]);
  if (table->variances.empty()) return;
  const auto back = parse_uncertain_poses_table(written, "fuzz");
  if (!back || back->variances.size() != table->variances.size()) std::abort();
  for (std::size_t i = 0; i < table->variances.size(); ++i)
    if (back->variances[i].attitude_rad2 != table->variances[i].attitude_rad2) std::abort();
}

void check_order(std::string_view text) {
  std::string torn;
  const auto rows = parse_order_table(text, "fuzz", &torn);
  if (!rows) return;
  std::string written = std::string(kOrderHeader) + "\n";
  for (const OrderRow& row : *rows) {
    if (row.recording.empty() || row.recording.find('/') != std::string::npos || row.recording == "..") std::abort();
    written += format_order_row(row);
  }
  const auto back = parse_order_table(written, "fuzz");
  if (!back || back->size() != rows->size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check_frames(text);
  check_poses(text);
  // Behind a good header the rows are reached at once.
  check_frames(std::string(kFramesHeader) + "\n" + std::string(text));
  check_poses(std::string(kPosesHeader) + "\n" + std::string(text));
  check_uncertain_poses(std::string(kUncertainPosesHeader) + "\n" + std::string(text));
  check_order(std::string(kOrderHeader) + "\n" + std::string(text));
  return 0;
}
