#include "drivers/fault_script.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <optional>

namespace scree::drivers {
namespace {

constexpr Duration kLongest = std::chrono::hours(24);
constexpr double kLargestFactor = 1e6;
constexpr std::uint64_t kMostFrames = 1'000'000'000;

struct Action {
  std::string_view name;
  std::string_view arguments;  ///< as messages show them
};

/// In the order of FaultKind.
constexpr std::array<Action, kFaultKinds> kActions{{{"unplug", "SECONDS"},
                                                    {"stall", ""},
                                                    {"babble", ""},
                                                    {"corrupt", "FRAMES"},
                                                    {"slow", "FACTOR SECONDS"},
                                                    {"wrong_geometry", "SECONDS"},
                                                    {"freeze", "SECONDS"}}};

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < line.size();) {
    while (at < line.size() && is_blank(line[at])) ++at;
    const std::size_t begin = at;
    while (at < line.size() && !is_blank(line[at])) ++at;
    if (at > begin) words.push_back(line.substr(begin, at - begin));
  }
  return words;
}

std::string action_names() {
  std::string names;
  for (const Action& action : kActions) names += fmt::format("{}{}", names.empty() ? "" : ", ", action.name);
  return names;
}

/// One line that is not empty.
class LineParser {
 public:
  LineParser(std::vector<std::string_view> words, std::string place)
      : words_(std::move(words)), place_(std::move(place)) {}

  Result<Fault> parse() {
    Fault fault;
    const auto at = seconds(words_[0]);
    if (!at) return wrong("a time in seconds, 0 … 86400", words_[0]);
    fault.at = *at;
    if (words_.size() < 2) return wrong("an action behind the time: " + action_names(), "nothing");
    const auto action =
        std::find_if(kActions.begin(), kActions.end(), [this](const Action& a) { return a.name == words_[1]; });
    if (action == kActions.end()) return wrong("one of " + action_names(), words_[1]);
    fault.kind = static_cast<FaultKind>(action - kActions.begin());
    const std::size_t count = words_of(action->arguments).size();
    if (words_.size() != 2 + count)
      return wrong(fmt::format("'{}{}{}'", action->name, count > 0 ? " " : "", action->arguments),
                   fmt::format("{} arguments", words_.size() - 2));
    return take_arguments(fault);
  }

 private:
  Error wrong(const std::string& expected, std::string_view found) const {
    return {ErrorKind::bad_data, fmt::format("{}: expected {}, found '{}'", place_, expected, found)};
  }

  static std::optional<Duration> seconds(std::string_view word) {
    const auto parsed = parse_seconds(word);
    if (!parsed || *parsed < Duration{0} || *parsed > kLongest) return std::nullopt;
    return *parsed;
  }

  template <class Number>
  static std::optional<Number> number(std::string_view word, Number least, Number most) {
    Number value{};
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (status != std::errc{} || end != word.data() + word.size() || !(value >= least && value <= most))
      return std::nullopt;
    return value;
  }

  Result<Fault> take_arguments(Fault fault) const {
    if (needs_endpoint(fault.kind)) return fault;
    if (fault.kind == FaultKind::corrupt) {
      const auto frames = number<std::uint64_t>(words_[2], 1, kMostFrames);
      if (!frames) return wrong("a number of frames, 1 … 1000000000", words_[2]);
      fault.frames = *frames;
      return fault;
    }
    if (fault.kind == FaultKind::slow) {
      const auto factor = number<double>(words_[2], 1e-3, kLargestFactor);
      if (!factor) return wrong("a factor of 0.001 … 1000000", words_[2]);
      fault.factor = *factor;
    }
    const auto lasts = seconds(words_.back());
    if (!lasts || *lasts == Duration{0}) return wrong("a duration in seconds, above 0, at most 86400", words_.back());
    fault.lasts = *lasts;
    return fault;
  }

  std::vector<std::string_view> words_;
  std::string place_;
};

}  // namespace

std::string_view to_string(FaultKind kind) {
  return kActions[static_cast<std::size_t>(kind)].name;
}

Result<std::vector<Fault>> parse_fault_script(std::string_view text, const std::string& file) {
  std::vector<Fault> faults;
  int line = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view whole = text.substr(begin, end - begin);
    begin = end + 1;
    ++line;
    auto words = words_of(whole.substr(0, whole.find('#')));
    if (words.empty()) continue;
    auto fault = LineParser(std::move(words), fmt::format("{}:{}", file, line)).parse();
    if (!fault) return fault.error();
    fault->line = line;
    if (!faults.empty() && fault->at < faults.back().at)
      return Error{ErrorKind::bad_data,
                   fmt::format("{}:{}: expected a time not before that of line {}, {} s, found {} s", file, line,
                               faults.back().line, format_seconds(faults.back().at), format_seconds(fault->at))};
    faults.push_back(*fault);
  }
  return faults;
}

Result<std::vector<Fault>> load_fault_script(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    return Error{ErrorKind::no_input, file.string() + ": expected a fault script that can be read, found none"};
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return parse_fault_script(text, file.string());
}

}  // namespace scree::drivers
