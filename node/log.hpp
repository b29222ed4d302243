#pragma once

namespace scree::node {

/// Logs go to stderr through spdlog.
void start_log();

}  // namespace scree::node
