#pragma once
// Numbers in the grammars of the simulator's command-line options.

#include <cstddef>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace scree::drivers {

/// "1,2.5,-3e2" to least … most finite numbers. Errors: usage, naming `grammar` (what was expected) and what was found.
Result<std::vector<double>> parse_numbers(std::string_view text, std::size_t least, std::size_t most,
                                          std::string_view grammar);

/// "usage: expected <grammar>, found '<text>' (<reason>)"
Error grammar_error(std::string_view grammar, std::string_view text, std::string_view reason);

}  // namespace scree::drivers
