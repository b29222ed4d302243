// D of every elevation model and survey at hand, as `scree dimension` says it. Prints the tables of
// docs/real-terrain.md; the plots stay in FOLDER.  Usage: dimension_study SCREE DATA [FOLDER_TO_KEEP]

#include <array>
#include <optional>

#include "tests/studies/dimension_inputs.hpp"
#include "tests/studies/study.hpp"

namespace {

using namespace scree;
using namespace scree::study;
using Json = nlohmann::json;

/// The tool's JSON, or why it refused.
struct Answer {
  std::optional<Json> json;
  std::string refusal;
};

Answer ask(const std::string& scree, const Input& input, std::vector<std::string> more = {}) {
  std::vector<std::string> command{scree, "dimension", input.path.string(), "--json"};
  command.insert(command.end(), input.options.begin(), input.options.end());
  command.insert(command.end(), more.begin(), more.end());
  const test::Finished finished = test::run(std::move(command), std::chrono::minutes(5));
  if (finished.exit_code == 0) return {Json::parse(finished.out), {}};
  if (finished.exit_code != 65) fail(input.name + ": " + finished.err);
  return {{}, finished.err};
}

std::string text(const char* format, double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

std::string number(const Json& json, const char* format) {
  return json.is_number() ? text(format, json.get<double>()) : "–";
}

/// "2.300 [2.250, 2.350]"
std::string with_interval(const Json& of) {
  std::string out = number(of.value("dimension", Json()), "%.3f");
  const Json interval = of.value("interval95", Json());
  if (!interval.is_array()) return out;
  return out.append(" [")
      .append(number(interval[0], "%.3f"))
      .append(", ")
      .append(number(interval[1], "%.3f"))
      .append("]");
}

std::string range(const Json& pair) {
  if (!pair.is_array() || !pair[0].is_number()) return "–";
  return number(pair[0], "%.3g").append(" … ").append(number(pair[1], "%.3g"));
}

std::string flags_of(const Json& json) {
  std::string out;
  for (const auto& flag : json.at("flags")) out.append(out.empty() ? "" : ", ").append(flag.get<std::string>());
  return out.empty() ? "none" : out;
}

/// What the structure function says over all distances.
std::string law_of(const Json& json) {
  const Json scales = json.value("scales", Json());
  if (!scales.is_object()) return "–";
  std::string out = scales.at("law").get<std::string>();
  out.append(": ")
      .append(with_interval(scales))
      .append(", ")
      .append(range(scales.value("range_m", Json())))
      .append(" m");
  const Json crossover = scales.value("crossover_m", Json());
  if (crossover.is_number()) out.append("; to ").append(number(crossover, "%.3g")).append(" m");
  const Json coarse = scales.value("coarse_dimension", Json());
  if (coarse.is_number()) out.append(", then ").append(number(coarse, "%.2f"));
  return out;
}

void print_answer(const Input& input, const Answer& answer) {
  std::string options;
  for (const auto& option : input.options) options.append(options.empty() ? "" : " ").append(option);
  std::printf("| %s | %s |", input.name.c_str(), options.c_str());
  if (!answer.json) {
    std::printf(" refused | | | | | | | |\n");
    return;
  }
  const Json& json = *answer.json;
  const Json check = json.value("check", Json());
  const Json coarse = json.at("coarse_dimension");
  const std::string part = coarse.is_number()
                               ? number(coarse, "%.3f").append(", ").append(number(json.at("coarse_spacing_m"), "%.3g"))
                               : std::string("–");
  std::printf(" %zu | %s | %s | %s | %s | %s | %s | %s |\n", json.at("points").get<std::size_t>(),
              number(json.at("spacing_m"), "%.3g").c_str(), with_interval(json).c_str(),
              number(json.at("noise_sigma_m"), "%.3g").c_str(), check.is_object() ? with_interval(check).c_str() : "–",
              part.c_str(), law_of(json).c_str(), flags_of(json).c_str());
  std::fflush(stdout);
}

void print_head() {
  std::puts(
      "| data | options | points | spacing, m | D [95 %] | noise, m | D, structure function [95 %] | D of a part, its "
      "spacing | law over all distances: D [95 %], range | flags |\n|---|---|---|---|---|---|---|---|---|---|");
}

/// Random choices of the points: the likelihood rests on the shortest distances there are, so D of fewer points is D at
/// larger scales.
void print_spacings(const std::string& scree, const fs::path& data) {
  constexpr std::array kCounts = {"100000", "20000", "5000", "2000", "1000", "400"};
  std::puts(
      "\n| | first straight part of the log–log plot: D [95 %], m | likelihood at a mean spacing of m: 100,000 points "
      "| "
      "20,000 | 5000 | 2000 | 1000 | 400 |\n|---|---|---|---|---|---|---|---|");
  for (const Input& input : terrain(data)) {
    if (input.name.empty()) continue;
    Input raw = input, coarse = input;
    if (input.name.find("Colorado") != std::string::npos) raw.options = {"--geographic"};
    if (input.name.find("SRTM") != std::string::npos) coarse.options = {"--noise-sigma-m", "0.289"};
    if (input.name.find("Colorado") != std::string::npos) coarse.options.emplace_back("--geographic");
    const Answer line = ask(scree, raw, {"--method", "pentland", "--segment", "polyline"});
    const std::string straight =
        line.json ? with_interval(*line.json).append(", ").append(range(line.json->at("scale_range_m"))) : "–";
    std::printf("| %s | %s |", input.name.c_str(), straight.c_str());
    for (const char* count : kCounts) {
      const Answer answer = ask(scree, coarse, {"--max-points", count});
      if (!answer.json || answer.json->at("points").get<std::size_t>() * 11 < std::stoul(count) * 10)
        std::printf(" |");  // there are not as many
      else
        std::printf(" %s at %s |", with_interval(*answer.json).c_str(),
                    number(answer.json->at("spacing_m"), "%.3g").c_str());
      std::fflush(stdout);
    }
    std::puts("");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) fail("usage: dimension_study SCREE DATA [FOLDER_TO_KEEP]");
  const std::string scree = argv[1];
  const fs::path data = argv[2];
  const test::TemporaryFolder temporary;
  const fs::path folder = argc == 4 ? fs::path(argv[3]) : temporary.path();
  fs::create_directories(folder);

  print_head();
  std::vector<std::string> refusals;
  int plots = 0;
  const auto print_all = [&](const std::vector<Input>& inputs) {
    for (const Input& input : inputs) {
      const std::string plot = (folder / ("plot_" + std::to_string(plots++) + ".png")).string();
      const Answer answer = ask(scree, input, {"--plot", plot});
      print_answer(input, answer);
      if (!answer.json) refusals.push_back(input.path.filename().string() + ": " + answer.refusal);
    }
  };
  print_all(terrain(data));
  std::puts("\nParts and changes of them:\n");
  print_head();
  print_all(derived(data, temporary.path()));
  std::puts("\nNot ground:\n");
  print_head();
  print_all(rooms(data, temporary.path()));
  for (const auto& refusal : refusals) std::printf("\nRefused: %s\n", refusal.c_str());
  print_spacings(scree, data);
}
