// Two clouds of a car's lidar in a street, each alone, through the node: what the map makes of them and what it costs.
// Prints the table "Urban lidar" of docs/accuracy.md.  Usage: clouds_study SCREE DATA [FOLDER_TO_KEEP]

#include "io/point_cloud.hpp"
#include "tests/studies/study.hpp"

namespace {

using namespace scree;
using namespace scree::study;

/// One frame, the sensor at the origin and level: the clouds say neither height nor attitude.
void write_recording(const fs::path& csv, const fs::path& directory) {
  fs::create_directories(directory / "frames");
  std::ofstream frame(directory / "frames" / "000000.bin", std::ios::binary);
  for (const Eigen::Vector4f& p : must(io::read_point_cloud(csv)).points)
    frame.write(reinterpret_cast<const char*>(p.data()), 4 * sizeof(float));
  std::ofstream(directory / "recording.yaml")
      << "scree_recording: 1\norigin: live\nsensor:\n  projection: cloud\n  T_body_sensor: {x_m: 0, y_m: 0, z_m: 0, "
         "qx: 0, qy: 0, qz: 0, qw: 1}\n  range_min_m: 1\n  range_max_m: 80\n"
         "  range_sigma_m: 0.02\n";
  std::ofstream(directory / "frames.csv") << "file,t_s,sequence\nframes/000000.bin,0,0\n";
  std::ofstream(directory / "poses.csv") << "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,1\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) fail("usage: clouds_study SCREE DATA [FOLDER_TO_KEEP]");
  const std::string scree = argv[1];
  const fs::path data = fs::path(argv[2]) / "libpointmatcher_clouds";
  const test::TemporaryFolder temporary;
  const fs::path folder = argc == 4 ? fs::path(argv[3]) : temporary.path();
  print_cost_heading();
  for (const std::string name : {"car_cloud400", "car_cloud401"}) {
    write_recording(data / (name + ".csv"), folder / name);
    const fs::path base = folder / (name + "_map");
    replay_map(scree, folder / name, base, {"map.cell_m=0.2", "map.size_cells=200"});
    print_costs(name, base);
  }
}
