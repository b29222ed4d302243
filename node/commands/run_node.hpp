#pragma once
// What `run` and `replay` have in common: outputs checked first, then the pipeline, then the outputs.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "drivers/source.hpp"
#include "node/commands/command_line.hpp"
#include "node/pipeline.hpp"

namespace scree::node {

struct NodeRun {
  PipelineConfig pipeline;
  drivers::Origin origin = drivers::Origin::live;
  OutputOptions output;
  std::optional<std::string> record;  ///< directory of a live recording
};

/// Several sources that are opened one after the other; the first error ends it.
using OpenSources = std::function<Result<std::vector<NodeSource>>()>;

/// Returns exit code 0, or why not.
Result<int> run_node(NodeRun run, const OpenSources& open);

}  // namespace scree::node
