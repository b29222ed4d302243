#pragma once
// A Source over a list of frame files and a pose track: what all recordings have in common once their tables are read.

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/recording.hpp"

namespace scree::drivers {

struct FrameEntry {
  std::filesystem::path file;
  Time time;  ///< of row 0
  std::uint64_t sequence = 0;
};

struct FileSourceSetup {
  std::string name;                ///< what messages and Source::name() call it
  std::vector<FrameEntry> frames;  ///< times increase strictly
  PoseTrack poses;
  SensorConfig sensor;
  std::vector<PoseVariance> variances;  ///< one a pose, or none
  std::string remark;                   ///< told before the first frame; mostly empty
};

/// Applies the window and checks that the poses reach into it. Errors: bad_data (no frame in the list, poses that cover
/// none of them), usage (a window behind the last frame).
Result<std::unique_ptr<Source>> make_file_source(FileSourceSetup setup, const ReplayWindow& window);

/// The text of a table. Errors: no_input, io, bad_data (beyond kTableMaxBytes).
Result<std::string> read_table_text(const std::filesystem::path& file);

/// poses.csv → track. Errors: those of read_table_text and parse_poses_table.
struct RecordedTrack {
  PoseTrack poses;
  std::vector<PoseVariance> variances;  ///< one a pose, or none
  std::string torn;                     ///< of a last line that was left out
};
Result<RecordedTrack> read_pose_track(const std::filesystem::path& file);

/// Files of `directory` with that extension, sorted by name. Errors: no_input (no directory), bad_data (no such file).
Result<std::vector<std::filesystem::path>> list_files(const std::filesystem::path& directory,
                                                      const std::string& extension);

}  // namespace scree::drivers
