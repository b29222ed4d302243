// scree reconstruct: sparse heights to a dense rough surface, with its uncertainty and draws.

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "node/commands/command_line.hpp"
#include "node/layer_files.hpp"
#include "node/length_text.hpp"
#include "node/progress.hpp"
#include "node/reconstruction_grid.hpp"
#include "node/reconstruction_law.hpp"
#include "node/reconstruction_methods.hpp"
#include "node/reconstruction_outputs.hpp"
#include "node/reconstruction_report.hpp"
#include "node/survey_input.hpp"
#include "node/worker_pool.hpp"

namespace scree::node {
namespace {

struct ReconstructOptions {
  std::string input;
  std::string method = reconstruction_methods().front();
  MethodOptions method_options;
  LawRequest law;
  double cell_m = 0.0;
  std::string extent;
  int draws = 1;
  SurveyReading reading;
  std::string out;
  bool json = false;
};

/// A pool and its threads, as many as the machine has.
class Workers {
 public:
  Workers() : pool_(static_cast<int>(std::thread::hardware_concurrency())) {
    for (int i = 1; i < pool_.threads(); ++i)
      threads_.emplace_back([this](const std::stop_token& stop) { pool_.work(stop); });
  }
  Executor& executor() { return pool_; }

 private:
  WorkerPool pool_;
  std::vector<std::jthread> threads_;
};

Status check(const ReconstructOptions& options) {
  if (Status status = check_length("--cell", options.cell_m, "metres above 0"); !status) return status;
  return check_method_options(options.method, options.method_options);
}

Result<int> reconstruct(const ReconstructOptions& options, const SurveyInput& input, PlacedSurvey placed,
                        const LayerFiles& files) {
  Workers workers;
  const auto law = resolve_law(input, placed, options.law, workers.executor());
  if (!law) return law.error();
  placed.samples.variance_m2.assign(placed.samples.size(), law->noise_sigma_m * law->noise_sigma_m);

  constexpr std::size_t kSteps = 1000;
  Progress progress(options.method, kSteps);
  SurfaceFiles outputs(files, placed.place);
  const fractal::SurfaceRequest request{
      .grid = placed.grid,
      .law = law->map,
      .draws = options.draws,
      .seed = options.law.seed,
      .on_draw = [&outputs](int k, const Grid<float>& draw_m) { outputs.take_draw(k, draw_m); },
      .on_progress = [&progress](double share) { progress.show(static_cast<std::size_t>(share * kSteps)); }};
  const auto answer = reconstruct_surface(options.method, placed, request, options.method_options, workers.executor());
  progress.clear();
  if (!answer) return answer.error();
  if (Status status = outputs.finish(answer->estimate, options.draws); !status) return status.error();

  const ReconstructionReport report{
      options.method, input, placed, *law, *answer, options.draws, outputs.dimension_of_draw()};
  if (!options.json)
    for (const std::string& remark : reconstruction_remarks(report)) spdlog::warn("{}", remark);
  if (Status status = print(options.json ? reconstruction_json(report) : reconstruction_line(report)); !status)
    return status.error();
  return 0;
}

Result<int> run_reconstruct(const ReconstructOptions& options) {
  if (Status status = check(options); !status) return status.error();
  ReconstructionGridOptions grid{options.cell_m, {}};
  if (!options.extent.empty()) {
    const auto extent = parse_extent(options.extent);
    if (!extent) return extent.error();
    grid.extent = *extent;
  }
  const auto files = LayerFiles::prepare("--out", options.out);
  if (!files) return files.error();
  if (Status status = check_creatable(files->file("mean")); !status) return status.error();
  const auto input = read_survey(options.input, options.reading);
  if (!input) return input.error();
  auto placed = place_survey(*input, grid);
  auto done = placed ? reconstruct(options, *input, *std::move(placed), *files) : Result<int>(placed.error());
  if (done || done.error().message.starts_with("--")) return done;
  return Error{done.error().kind, options.input + ": " + done.error().message};
}

constexpr std::int64_t kMostInsertions = 200'000'000;

void add_method_options(CLI::App& command, MethodOptions& options) {
  command
      .add_option("--fields", options.fields, "conditional: residual fields behind the standard deviation; default 8")
      ->check(CLI::Range(1, 10'000))
      ->type_name("K");
  command.add_flag("--keep-outliers", options.keep_outliers, "conditional: believe every sample");
  command.add_flag("--breaks", options.breaks, "conditional: let the surface break at cliffs and rocks");
  command
      .add_option("--ceiling", options.ceiling, "conditional: raster of the lowest ray over each cell; nodata = none")
      ->type_name("FILE");
  command.add_option("--temperature", options.temperature, "szeliski: of the prior; default closed-form")
      ->type_name("empirical|formula|closed-form|M2");
  command.add_option("--sweeps", options.sweeps, "szeliski: of every level; default 50")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  command.add_option("--iterations", options.iterations, "polyhedron: default until no edge is longer than a cell")
      ->check(CLI::Range(1, 30))
      ->type_name("N");
  command.add_option("--insertions", options.insertions, "barycentre: points; default one a cell")
      ->check(CLI::Range(std::int64_t{0}, kMostInsertions))
      ->type_name("N");
  command
      .add_option("--barycentre-law", options.barycentre_law,
                  "barycentre: how a height follows from its triangle; default published")
      ->type_name("published|exact-variance|conditional|neighbours|corrected");
  command
      .add_option("--regions", options.regions,
                  "barycentre: centres with laws of their own; x_m,y_m,dimension,amplitude_m")
      ->type_name("FILE.csv");
}

}  // namespace

Command add_reconstruct(CLI::App& app) {
  auto options = std::make_shared<ReconstructOptions>();
  CLI::App* command =
      app.add_subcommand("reconstruct", "Sparse heights to a dense rough surface: mean, standard deviation, draws");
  command->add_option("INPUT", options->input, "Points (.xyz .txt .csv .bin .pcd .ply), a raster or a recording")
      ->required();
  command->add_option("--cell", options->cell_m, "Side of a cell; default a raster's own")->type_name("M");
  command->add_option("--extent", options->extent, "Outer borders; default the samples' box grown to whole cells")
      ->type_name("XMIN,YMIN,XMAX,YMAX");
  command->add_option("--method", options->method, "Default conditional")
      ->check(CLI::IsMember(reconstruction_methods()))
      ->type_name("NAME");
  command
      ->add_option("--dimension", options->law.dimension,
                   "Fractal dimension, of every cell with a raster; default auto")
      ->type_name("D|auto|FILE");
  command->add_option("--amplitude-m", options->law.amplitude, "rms height change over 1 m; default auto")
      ->type_name("A|auto|FILE");
  command
      ->add_option("--noise-sigma-m", options->law.noise,
                   "Noise of a height; default auto: repeated samples, a recording's sensor, else 1 % of the change "
                   "over a cell")
      ->type_name("S|auto");
  command->add_option("--draws", options->draws, "Surfaces drawn; default 1")
      ->check(CLI::Range(0, 10'000))
      ->type_name("K");
  add_method_options(*command, options->method_options);
  add_seed(*command, [options](std::uint64_t seed) { options->law.seed = options->reading.seed = seed; });
  command->add_option("--out", options->out, "BASE.mean.EXT, BASE.sd.EXT, BASE.draw0.EXT, ...; tif, npy or png")
      ->required()
      ->type_name("BASE.EXT");
  command->add_flag("--json", options->json, "Print one JSON document");
  return {command, [options] { return run_reconstruct(*options); }};
}

}  // namespace scree::node
