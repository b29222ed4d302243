#include "node/commands/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>
#include <sstream>
#include <string>
#include <utility>

#include "config/loader.hpp"
#include "node/log.hpp"

namespace scree::node {
namespace {

constexpr int kUsage = static_cast<int>(ErrorKind::usage);
constexpr std::uint64_t kSeedMax = 9'200'000'000'000'000'000;  // what the keys map.seed and source.seed take

int report(const Error& error) {
  std::fprintf(stderr, "scree: %s\n", error.message.c_str());
  return static_cast<int>(error.kind);
}

/// CLI11 reports through exceptions; they end here.
int parse_and_run(CLI::App& app, const std::vector<Command>& commands, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      std::ostringstream text;
      app.exit(error, text, text);
      const auto printed = print(text.str());
      return printed ? 0 : report(printed.error());
    }
    std::fprintf(stderr, "scree: %s\nTry scree --help, or scree COMMAND --help.\n", error.what());
    return kUsage;
  }
  for (const auto& command : commands) {
    if (!command.app->parsed()) continue;
    const auto code = command.run();
    return code ? *code : report(code.error());
  }
  std::fputs(app.help().c_str(), stderr);
  return kUsage;
}

}  // namespace

int run_command_line(int argc, char** argv) {
  CLI::App app(
      "Scree tells a robot how rough the ground is: range frames in, a map of elevation,\n"
      "fractal dimension D and traversability cost out, over UDP.",
      "scree");
  app.set_version_flag("--version", "scree " SCREE_VERSION);
  app.set_help_flag("-h,--help", "Show this, or a command's options after its name");
  app.footer(
      "Exit codes: 0 ok, 64 usage, 65 bad data, 66 no such input, 69 device or port\n"
      "unavailable, 70 bug, 73 cannot create output, 74 I/O error, 78 bad configuration.");
  std::vector<Command> commands{add_run(app),         add_replay(app), add_simulate(app),   add_listen(app),
                                add_plan(app),        add_top(app),    add_synthesize(app), add_dimension(app),
                                add_reconstruct(app), add_devices(app)};
  for (auto& command : add_config(app)) commands.push_back(std::move(command));
  start_log();
  try {
    return parse_and_run(app, commands, argc, argv);
  } catch (const std::exception& error) {  // ours does not throw: memory ran out, or a library's exception got away
    return report({ErrorKind::internal, std::string("unexpected: ") + error.what()});
  }
}

Status print(const std::string& text) {
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (written && std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return {};
  const char* reason = errno != 0 ? std::strerror(errno) : "an earlier write failed";
  return Error{ErrorKind::io, std::string("standard output: expected to take the result, found: ") + reason};
}

/// Read by hand: the option parser would take -1 for 2^64 − 1 or 0.
void add_seed(CLI::App& app, std::function<void(std::uint64_t)> take) {
  const auto read = [take = std::move(take)](const std::string& text) {
    std::uint64_t seed = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), seed);
    if (status != std::errc{} || end != text.data() + text.size() || seed > kSeedMax)
      throw CLI::ValidationError("--seed", "expected an integer from 0 to 9.2e18, found '" + text + "'");
    take(seed);
  };
  app.add_option_function<std::string>("--seed", read, "Makes everything random repeatable")->type_name("N");
}

void ConfigOptions::add_to(CLI::App& app) {
  app.add_option("--config", file, "Configuration file (YAML)")->type_name("FILE");
  app.add_option("--set", assignments, "Override one key, e.g. node.threads=2; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  add_seed(app, [this](std::uint64_t value) { seed = value; });
}

Result<config::Settings> ConfigOptions::load() const {
  auto settings = config::load_settings(file, assignments);
  if (settings && seed) settings->map.seed = *seed;
  return settings;
}

void OutputOptions::add_to(CLI::App& app) {
  app.add_option("--map-out", map_out, "Write every layer of the last map (tif, npy, png) and BASE.json")
      ->type_name("BASE.EXT");
  app.add_option("--snapshot", snapshot, "Picture of the last map")->type_name("FILE.png");
  app.add_flag("--json", json, "Print the statistics as one JSON document");
}

}  // namespace scree::node
