// The simulated scanner as a writer of recordings.

#include <fmt/format.h>
#include <system_error>

#include "drivers/simulator.hpp"
#include "drivers/table.hpp"
#include "io/file_bytes.hpp"
#include "io/npy.hpp"
#include "io/raster.hpp"

namespace scree::drivers {
namespace {

Status write_terrain(const Terrain& terrain, const std::filesystem::path& truth) {
  const auto written = io::write_geotiff(truth / "terrain.tif", terrain.raster());
  if (written || written.error().kind != ErrorKind::unavailable) return written;
  return io::write_npy(truth / "terrain.npy", terrain.raster().height_m);  // a build without GDAL
}

Status write_poses(const Simulator& simulator, const std::filesystem::path& truth, RecordingWriter& writer) {
  for (const StampedPose& pose : simulator.odometry().poses())
    if (auto status = writer.add_pose(pose); !status) return status;
  std::string table(kPosesHeader);
  table += '\n';
  for (const StampedPose& pose : simulator.poses().poses()) table += format_pose_row(pose);
  return io::write_bytes(truth / "poses.csv", {reinterpret_cast<const std::uint8_t*>(table.data()), table.size()});
}

Status write_frame(const SimulatedFrame& frame, const Simulator& simulator, const std::filesystem::path& truth,
                   RecordingWriter& writer) {
  const ProjectionKind kind = simulator.description().sensor.projection.kind;
  if (auto status = writer.add_raw_frame(kind, frame.raw, frame.time, frame.sequence); !status) return status;
  return io::write_npy(truth / fmt::format("{:06}.range.npy", frame.sequence), frame.true_range_m);
}

}  // namespace

Status write_recording(const Simulator& simulator, const std::filesystem::path& directory,
                       const std::string& recording_yaml, Executor& executor, const FrameProgress& progress) {
  auto writer = RecordingWriter::create(directory, recording_yaml);
  if (!writer) return writer.error();
  const auto truth = directory / "truth";
  std::error_code failed;
  std::filesystem::create_directories(truth, failed);
  if (failed)
    return Error{ErrorKind::cannot_create, fmt::format("{}: cannot be created: {}", truth.string(), failed.message())};
  if (auto status = write_terrain(simulator.terrain(), truth); !status) return status;
  if (auto status = write_poses(simulator, truth, *writer); !status) return status;
  for (std::size_t i = 0; i < simulator.frame_count(); ++i) {
    const auto frame = simulator.render(i, executor);
    if (!frame) return frame.error();
    if (auto status = write_frame(*frame, simulator, truth, *writer); !status) return status;
    if (progress) progress(i + 1, simulator.frame_count());
  }
  return writer->finish();
}

}  // namespace scree::drivers
