// scree synthesize: a surface of known law, or one of the literature's generators, as a raster.

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <spdlog/spdlog.h>
#include <string>

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
  const auto& [model, law, size, cell_m, seed, out] = options;
  if (model == "fbm") return fractal::fbm_surface(law, size, size, cell_m, seed);
  if (model == "sra") return fractal::successive_random_additions(law, size, size, cell_m, seed);
  if (model == "midpoint-square") return fractal::midpoint_displacement_squares(law, size, size, cell_m, seed);
  return fractal::midpoint_displacement_triangles(law, size, size, cell_m, seed);
}

Status write_surface(const SynthesizeOptions& options, Grid<float> surface) {
  const std::filesystem::path out = options.out;
  if (out.extension() == ".npy") return io::write_npy(out, surface);
  if (out.extension() == ".tif")
    return io::write_geotiff(out, {std::move(surface), 0.0, 0.0, options.cell_m, options.cell_m, false});
  const std::string title = fmt::format("{}, D = {:g}, height (m)", options.model, options.law.dimension);
  return io::write_layer_picture(out, {title, std::move(surface), {io::ColourMap::terrain, {}, {}, true}},
                                 {0.0, 0.0, options.cell_m});
}

Result<int> run_synthesize(const SynthesizeOptions& options) {
  if (const auto possible = check_output(options.out); !possible) return possible.error();
  auto surface = make_surface(options);
  if (!surface) return surface.error();
  if (const auto written = write_surface(options, std::move(*surface)); !written) return written.error();
  spdlog::info("{}: {} x {} values of {}, D = {:g}, amplitude {:g} m, cell {:g} m, seed {}", options.out, options.size,
               options.size, options.model, options.law.dimension, options.law.amplitude_m, options.cell_m,
               options.seed);
  return 0;
}

}  // namespace

Command add_synthesize(CLI::App& app) {
  auto options = std::make_shared<SynthesizeOptions>();
  CLI::App* command = app.add_subcommand("synthesize", "Make a fractal surface: N x N heights of a chosen law");
  command
      ->add_option(
          "--model", options->model,
          "fbm: exact fractional Brownian motion, the one to test against; the others repeat the generators of "
          "the literature, whose D is not what they are asked for")
      ->required()
      ->check(CLI::IsMember({"fbm", "sra", "midpoint-square", "midpoint-triangle"}))
      ->type_name("fbm|sra|midpoint-square|midpoint-triangle");
  command->add_option("--dimension", options->law.dimension, "Fractal dimension, between 2 and 3 (fbm: 2.05 to 2.95)")
      ->required()
      ->type_name("D");
  command->add_option("--amplitude-m", options->law.amplitude_m, "rms height change over 1 m")
      ->required()
      ->type_name("A");
  command->add_option("--size", options->size, "Values a side")->required()->type_name("N");
  command->add_option("--cell", options->cell_m, "Distance between values, metres")->required()->type_name("M");
  command->add_option("--seed", options->seed, "Which surface; default 1")->type_name("S");
  command->add_option("--out", options->out, "GeoTIFF, NumPy array or picture by its ending")
      ->required()
      ->type_name("FILE.tif|.npy|.png");
  return {command, [options] { return run_synthesize(*options); }};
}

}  // namespace scree::node
