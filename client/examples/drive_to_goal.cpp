// Drives the simulated robot to a goal: the smallest whole planner.
//
//   c++ -std=c++17 -O2 -I ROOT_OF_SCREE client/examples/drive_to_goal.cpp -o drive_to_goal
//   drive_to_goal NODE DRIVE GOAL_X GOAL_Y [sim]    e.g. 127.0.0.1:47801 127.0.0.1:47820 8 0 sim
//
// Without `sim` it drives by LIVE maps alone.
//
// NODE is the node's publish.listen, DRIVE what `scree simulate --drive` listens on. docs/client.md has the rest of the
// constellation; `scree plan` is the same with options. MIT licence, as the rest of Scree.

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "client/examples/drive_command.hpp"
#include "client/examples/map_driver.hpp"

int main(int argc, char** argv) {
  const bool sim = argc == 6 && std::strcmp(argv[5], "sim") == 0;
  if (argc != 5 && !sim) {
    std::fprintf(stderr, "usage: drive_to_goal NODE DRIVE GOAL_X GOAL_Y [sim]\n");
    return 64;
  }
  scree_example::DriverConfig config;
  config.map.bind = "127.0.0.1:0";  // the node sends to where the subscription comes from
  config.map.node = argv[1];
  config.map.layers = scree::client::layer_bit(scree::client::Layer::cost);
  if (sim) config.map.accept_origins |= scree::client::origin_bit(scree::client::Origin::sim);
  config.goal = {std::atof(argv[3]), std::atof(argv[4])};
  if (!std::isfinite(config.goal.x_m) || !std::isfinite(config.goal.y_m)) {
    std::fprintf(stderr, "GOAL_X GOAL_Y: expected metres, found %s %s\n", argv[3], argv[4]);
    return 64;
  }
  scree_example::MapDriver driver;
  if (!driver.open(config)) {
    std::fprintf(stderr, "%s\n", driver.error());
    return 69;
  }
  scree_example::DriveSender wheels;
  if (!wheels.open(argv[2])) {
    std::fprintf(stderr, "%s: expected a numeric ADDRESS:PORT\n", argv[2]);
    return 64;
  }
  while (!driver.done()) {
    driver.wait();
    wheels.send(driver.step());
  }
  wheels.send({});
  const bool arrived = driver.phase() == scree_example::Phase::arrived;
  std::printf("%s at (%.2f, %.2f)\n", arrived ? "arrived" : "no path", driver.posture().at.x_m,
              driver.posture().at.y_m);
  return arrived ? 0 : 1;
}
