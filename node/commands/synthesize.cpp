// scree synthesize: a surface of known law, or one of the literature's generators, as a raster.

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <spdlog/spdlog.h>
#include <string>

#include "fractal/combined_surface.hpp"
#include "fractal/midpoint_displacement.hpp"
#include "fractal/successive_random_additions.hpp"
#include "fractal/surface.hpp"
#include "io/npy.hpp"
#include "io/picture.hpp"
#include "io/raster.hpp"
#include "node/commands/command_line.hpp"
#include "node/layer_files.hpp"

namespace scree::node {
namespace {

struct SynthesizeOptions {
  std::string model;
  fractal::FractalLaw law;
  fractal::CombinedLaw combined;
  int size = 0;
  double cell_m = 0.0;
  std::uint64_t seed = 1;
  std::string out;
};

#ifdef SCREE_WITH_GDAL
constexpr bool kRasterSupport = true;
#else
constexpr bool kRasterSupport = false;
#endif

/// Said before the surface is made.
Status check_output(const std::filesystem::path& out) {
  const std::string extension = out.extension().string();
  if (extension != ".tif" && extension != ".npy" && extension != ".png")
    return Error{ErrorKind::usage,
                 fmt::format("--out {}: expected a file that ends in .tif, .npy or .png", out.string())};
  if (extension == ".tif" && !kRasterSupport)
    return Error{ErrorKind::unavailable, fmt::format("--out {}: this build has no GDAL; use .npy", out.string())};
  if (extension == ".png" && !io::picture_support())
    return Error{ErrorKind::unavailable, fmt::format("--out {}: this build has no pictures; use .npy", out.string())};
  return check_creatable(out);
}

Result<Grid<float>> make_surface(const SynthesizeOptions& options) {
  const auto& [model, law, combined, size, cell_m, seed, out] = options;
  if (size < 2) return Error{ErrorKind::usage, fmt::format("--size {}: expected at least 2 values a side", size)};
  if (model == "fbm") return fractal::fbm_surface(law, size, size, cell_m, seed);
  if (model == "combined") {
    fractal::CombinedLaw both = combined;
    both.amplitude_m = law.amplitude_m;
    return fractal::combined_surface(both, size, size, cell_m, seed);
  }
  if (model == "sra") return fractal::successive_random_additions(law, size, size, cell_m, seed);
  if (model == "midpoint-square") return fractal::midpoint_displacement_squares(law, size, size, cell_m, seed);
  return fractal::midpoint_displacement_triangles(law, size, size, cell_m, seed);
}

std::string law_text(const SynthesizeOptions& options) {
  if (options.model == "combined")
    return fmt::format("H = {:g} along x, {:g} along y", options.combined.hurst_x, options.combined.hurst_y);
  return fmt::format("D = {:g}", options.law.dimension);
}

Status write_surface(const SynthesizeOptions& options, Grid<float> surface) {
  const std::filesystem::path out = options.out;
  if (out.extension() == ".npy") return io::write_npy(out, surface);
  if (out.extension() == ".tif")
    return io::write_geotiff(out, {std::move(surface), 0.0, 0.0, options.cell_m, options.cell_m, false});
  const std::string title = fmt::format("{}, {}, height (m)", options.model, law_text(options));
  return io::write_layer_picture(out, {title, std::move(surface), {io::ColourMap::terrain, {}, {}, true}},
                                 {0.0, 0.0, options.cell_m});
}

/// Options that the model needs, and those it has no use for.
Status check_options(const CLI::App& command, const SynthesizeOptions& options) {
  const bool combined = options.model == "combined";
  const auto given = [&](const char* name) { return command.count(name) > 0; };
  const auto usage = [&](const char* name, const char* what) {
    return Error{ErrorKind::usage, fmt::format("--model {}: {} {}", options.model, name, what)};
  };
  for (const char* name : {"--hx", "--hy"})
    if (combined && !given(name)) return usage(name, "is required");
  if (!combined && !given("--dimension")) return usage("--dimension", "is required");
  if (combined && given("--dimension"))
    return usage("--dimension", "does not go with it: D differs with the direction, give --hx and --hy");
  for (const char* name : {"--hx", "--hy", "--weight", "--correlation"})
    if (!combined && given(name)) return usage(name, "does not go with it: it belongs to --model combined");
  return {};
}

Result<int> run_synthesize(const CLI::App& command, const SynthesizeOptions& options) {
  if (const auto coherent = check_options(command, options); !coherent) return coherent.error();
  if (const auto possible = check_output(options.out); !possible) return possible.error();
  auto surface = make_surface(options);
  if (!surface) return surface.error();
  if (const auto written = write_surface(options, std::move(*surface)); !written) return written.error();
  spdlog::info("{}: {} x {} values of {}, {}, amplitude {:g} m, cell {:g} m, seed {}", options.out, options.size,
               options.size, options.model, law_text(options), options.law.amplitude_m, options.cell_m, options.seed);
  return 0;
}

}  // namespace

Command add_synthesize(CLI::App& app) {
  auto options = std::make_shared<SynthesizeOptions>();
  CLI::App* command = app.add_subcommand("synthesize", "Make a fractal surface: N x N heights of a chosen law");
  command
      ->add_option(
          "--model", options->model,
          "fbm: exact fractional Brownian motion, the one to test against; combined: a profile along x plus one along "
          "y, each with its own H; the others repeat the generators of the literature, whose D is not what they are "
          "asked for")
      ->required()
      ->check(CLI::IsMember({"fbm", "combined", "sra", "midpoint-square", "midpoint-triangle"}))
      ->type_name("fbm|combined|sra|midpoint-square|midpoint-triangle");
  command->add_option("--dimension", options->law.dimension, "Fractal dimension, between 2 and 3 (fbm: 2.05 to 2.95)")
      ->type_name("D");
  command->add_option("--hx", options->combined.hurst_x, "combined: H along x, between 0 and 1")->type_name("H");
  command->add_option("--hy", options->combined.hurst_y, "combined: H along y")->type_name("H");
  command->add_option("--weight", options->combined.weight, "combined: share of the profile along x; default 0.5")
      ->type_name("P");
  command->add_option("--correlation", options->combined.correlation, "combined: of the two profiles; default 0")
      ->type_name("R");
  command
      ->add_option("--amplitude-m", options->law.amplitude_m,
                   "rms height change over 1 m (combined: of either profile)")
      ->required()
      ->type_name("A");
  command->add_option("--size", options->size, "Values a side")->required()->type_name("N");
  command->add_option("--cell", options->cell_m, "Distance between values, metres")->required()->type_name("M");
  command->add_option("--seed", options->seed, "Which surface; default 1")->type_name("S");
  command->add_option("--out", options->out, "GeoTIFF, NumPy array or picture by its ending")
      ->required()
      ->type_name("FILE.tif|.npy|.png");
  return {command, [command, options] { return run_synthesize(*command, *options); }};
}

}  // namespace scree::node
