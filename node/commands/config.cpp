// scree config check|dump|keys

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <memory>
#include <string>
#include <vector>

#include "config/loader.hpp"
#include "node/commands/command_line.hpp"
#include "node/protocol_header.hpp"

namespace scree::node {
namespace {

struct CheckOptions {
  std::string file;
  ConfigOptions config;
};

void add_options(CLI::App& command, CheckOptions& options) {
  command.add_option("FILE", options.file, "Configuration file (YAML)")->required();
  command.add_option("--set", options.config.assignments, "Override one key; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

Result<int> run_check(CheckOptions options, bool dump) {
  options.config.file = options.file;
  const auto settings = options.config.load();
  if (!settings) return settings.error();
  const std::string text = config::dump_settings(*settings);
  const auto printed =
      print(dump ? text : fmt::format("{}: valid, config_hash {:08x}\n", options.file, protocol::config_hash(text)));
  if (!printed) return printed.error();
  return 0;
}

Result<int> print_keys() {
  if (const auto printed = print(config::settings_table()); !printed) return printed.error();
  return 0;
}

}  // namespace

std::vector<Command> add_config(CLI::App& app) {
  CLI::App* group = app.add_subcommand("config", "check or dump a configuration, list its keys");
  group->require_subcommand(1);
  auto check_options = std::make_shared<CheckOptions>();
  auto dump_options = std::make_shared<CheckOptions>();
  CLI::App* check = group->add_subcommand("check", "Validate: every fault with file:line:column, exit code 78");
  add_options(*check, *check_options);
  CLI::App* dump = group->add_subcommand("dump", "Print the effective configuration as YAML");
  add_options(*dump, *dump_options);
  CLI::App* keys = group->add_subcommand("keys", "Print the table of all keys (Markdown)");
  return {{check, [check_options] { return run_check(*check_options, false); }},
          {dump, [dump_options] { return run_check(*dump_options, true); }},
          {keys, print_keys}};
}

}  // namespace scree::node
