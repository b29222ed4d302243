#pragma once
// The command line: one subcommand a file; each returns the exit code or an Error that carries it.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/settings.hpp"
#include "core/result.hpp"

namespace CLI {
class App;
}

namespace scree::node {

struct Command {
  CLI::App* app = nullptr;
  std::function<Result<int>()> run;
};

/// Each adds its subcommand with its options.
Command add_run(CLI::App& app);
Command add_replay(CLI::App& app);
Command add_simulate(CLI::App& app);
Command add_synthesize(CLI::App& app);
Command add_listen(CLI::App& app);
Command add_plan(CLI::App& app);
Command add_top(CLI::App& app);
Command add_devices(CLI::App& app);
Command add_dimension(CLI::App& app);
Command add_reconstruct(CLI::App& app);
std::vector<Command> add_config(CLI::App& app);

/// Parses, runs, reports: the whole of main.
int run_command_line(int argc, char** argv);

/// Writes `text` to standard output and makes sure that it got there: a program that reads it must not take a lost
/// document for an empty one. Errors: io.
Status print(const std::string& text);

/// --seed: an integer that a configuration can hold too.
void add_seed(CLI::App& app, std::function<void(std::uint64_t)> take);

/// --config, --set and --seed, the same everywhere.
struct ConfigOptions {
  std::optional<std::string> file;
  std::vector<std::string> assignments;
  std::optional<std::uint64_t> seed;  ///< of the map's random part

  void add_to(CLI::App& app);
  Result<config::Settings> load() const;
};

/// --map-out, --snapshot and --json.
struct OutputOptions {
  std::optional<std::string> map_out;
  std::optional<std::string> snapshot;
  bool json = false;

  void add_to(CLI::App& app);
};

}  // namespace scree::node
