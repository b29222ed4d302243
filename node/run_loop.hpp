#pragma once
// A pipeline from start to end in main's thread: signals, the statistics line, the progress bar.

#include <cstddef>
#include <memory>
#include <optional>

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
Result<Outcome> run_to_end(PipelineConfig config, std::unique_ptr<drivers::Source> source, std::unique_ptr<Inbox> inbox,
                           std::unique_ptr<Publisher> publisher);

}  // namespace scree::node
