#pragma once
// A pipeline from start to end in main's thread: signals, the statistics line, the progress bar.

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "node/pipeline.hpp"

namespace scree::node {

struct Outcome {
  Statistics statistics;
  std::shared_ptr<const mapping::MapSnapshot> map;  ///< null: no frame was mapped
  bool interrupted = false;                         ///< by SIGINT or SIGTERM
  std::optional<Error> publish_error;               ///< the map is complete but was not published whole
};

/// Runs until the source ends or a signal comes. Errors: what ended the source early; bad_data when it ended without
/// one frame that could be mapped.
/// Tells systemd, when it asked, that the node is ready, how it is, and that it lives: the watchdog is fed only while
/// acquire, map, publish and receive all advance.
Result<Outcome> run_to_end(PipelineConfig config, std::vector<NodeSource> sources, std::unique_ptr<Inbox> inbox,
                           std::unique_ptr<Publisher> publisher, std::unique_ptr<Recorder> recorder);

/// "front, rear"; of one source its own name.
std::string names_of(const std::vector<NodeSource>& sources);

}  // namespace scree::node
