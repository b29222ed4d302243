#include "drivers/simulator_grammar.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace scree::drivers {

Error grammar_error(std::string_view grammar, std::string_view text, std::string_view reason) {
  return {ErrorKind::usage, fmt::format("expected {}, found '{}' ({})", grammar, text, reason)};
}

Result<std::vector<double>> parse_numbers(std::string_view text, std::size_t least, std::size_t most,
                                          std::string_view grammar) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto item = text.substr(begin, end - begin);
    double value = 0.0;
    const auto [stop, status] = std::from_chars(item.data(), item.data() + item.size(), value);
    if (status != std::errc{} || stop != item.data() + item.size() || !std::isfinite(value))
      return grammar_error(grammar, text, fmt::format("'{}' is not a finite number", item));
    numbers.push_back(value);
    begin = end + 1;
  }
  if (numbers.size() < least || numbers.size() > most)
    return grammar_error(grammar, text, fmt::format("{} numbers", numbers.size()));
  return numbers;
}

}  // namespace scree::drivers
