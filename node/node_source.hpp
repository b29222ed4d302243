#pragma once
// From what the user names to a Source.

#include <memory>
#include <string>

#include "config/settings.hpp"
#include "core/result.hpp"
#include "drivers/recording.hpp"
#include "drivers/source.hpp"

namespace scree::node {

/// What `scree replay` reads: `format` is "auto", "kitti" or "pcd". auto: a directory is a recording, a file a range
/// file. The sensor is what the recording says, with the configuration's overrides. Errors: no_input, bad_data,
/// bad_config, usage.
Result<std::unique_ptr<drivers::Source>> open_input(const std::string& path, const std::string& format,
                                                    const drivers::ReplayWindow& window,
                                                    const config::Settings& settings);

/// One of the sources that `scree run` acquires from. Errors as above; bad_config for kind none.
Result<std::unique_ptr<drivers::Source>> open_live(const config::SourceSettings& source,
                                                   const config::Settings& settings);

}  // namespace scree::node
