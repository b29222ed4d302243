#pragma once
// Every key of a configuration file.

#include "config/schema.hpp"
#include "config/settings.hpp"

namespace scree::config {

const Schema<Settings>& settings_schema();

}  // namespace scree::config
