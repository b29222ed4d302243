#pragma once
// What `run` and `replay` have in common: outputs checked first, then the pipeline, then the outputs.

#include <functional>
#include <memory>

#include "core/result.hpp"
#include "drivers/source.hpp"
#include "node/commands/command_line.hpp"
#include "node/pipeline.hpp"

namespace scree::node {

struct NodeRun {
  PipelineConfig pipeline;
  drivers::Origin origin = drivers::Origin::live;
  OutputOptions output;
};

/// Returns exit code 0, or why not.
Result<int> run_node(NodeRun run, const std::function<Result<std::unique_ptr<drivers::Source>>()>& open);

}  // namespace scree::node
