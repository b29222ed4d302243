#include "node/commands/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>

#include "config/loader.hpp"
#include "node/log.hpp"

namespace scree::node {
namespace {

constexpr int kUsage = static_cast<int>(ErrorKind::usage);

int report(const Error& error) {
  std::fprintf(stderr, "scree: %s\n", error.message.c_str());
  return static_cast<int>(error.kind);
}

/// CLI11 reports through exceptions; they end here.
int parse_and_run(CLI::App& app, const std::vector<Command>& commands, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
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
  std::vector<Command> commands{add_run(app), add_replay(app), add_simulate(app), add_listen(app)};
  for (auto& command : add_config(app)) commands.push_back(std::move(command));
  start_log();
  try {
    return parse_and_run(app, commands, argc, argv);
  } catch (const std::exception& error) {  // ours does not throw: memory ran out, or a library's exception got away
    return report({ErrorKind::internal, std::string("unexpected: ") + error.what()});
  }
}

void ConfigOptions::add_to(CLI::App& app) {
  app.add_option("--config", file, "Configuration file (YAML)")->type_name("FILE");
  app.add_option("--set", assignments, "Override one key, e.g. node.threads=2; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  app.add_option("--seed", seed, "Makes everything random repeatable")->type_name("N");
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
