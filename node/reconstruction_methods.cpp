#include "node/reconstruction_methods.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <string_view>
#include <utility>

#include "fractal/reconstruction/barycentre.hpp"
#include "fractal/reconstruction/cell_samples.hpp"
#include "fractal/reconstruction/data_gaps.hpp"
#include "fractal/reconstruction/kriging.hpp"
#include "fractal/reconstruction/polyhedron.hpp"
#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "fractal/reconstruction/spline.hpp"
#include "fractal/reconstruction/szeliski.hpp"
#include "fractal/reconstruction/yokoya.hpp"
#include "node/reconstruction_regions.hpp"

namespace scree::node {
namespace {

using fractal::BarycentreLaw;
using fractal::SurfaceEstimate;

constexpr std::array<std::pair<std::string_view, BarycentreLaw>, 4> kBarycentreLaws{
    {{"published", BarycentreLaw::published},
     {"exact-variance", BarycentreLaw::exact_variance},
     {"conditional", BarycentreLaw::conditional},
     {"neighbours", BarycentreLaw::neighbours}}};

std::optional<BarycentreLaw> barycentre_law(const std::string& name) {
  for (const auto& [known, law] : kBarycentreLaws)
    if (known == name) return law;
  return std::nullopt;
}

/// What the kernel reckons that a process may take without swapping; 0 = it does not say.
std::size_t free_memory_bytes() {
  std::ifstream table("/proc/meminfo");
  std::string name, unit;
  std::size_t kilobytes = 0;
  while (table >> name >> kilobytes) {
    if (name == "MemAvailable:") return kilobytes * 1024;
    std::getline(table, unit);
  }
  return 0;
}

/// Peak, samples and result included.
std::size_t needed_bytes(const std::string& method, const PlacedSurvey& placed, const fractal::CellSamples& binned,
                         const fractal::SurfaceRequest& request, const MethodOptions& options) {
  const auto& [rows, columns, cell_m] = request.grid;
  const std::int64_t cells = std::int64_t{rows} * columns;
  if (method == "conditional") {
    const bool keeps = options.breaks || options.ceiling;
    return fractal::conditional_memory_bytes(rows, columns, request.law.varies(),
                                             {.gap_cells = fractal::widest_gap_cells(binned.height_m),
                                              .kept_draws = keeps ? request.draws : 0,
                                              .ceilings = options.ceiling.has_value()});
  }
  constexpr std::int64_t kOthers = 80;  // bytes a cell: samples, mean, sd, solver or four realisations
  if (method != "barycentre") return static_cast<std::size_t>(kOthers * cells);
  const std::int64_t last = options.barycentre_law == "corrected" ? cells : 0;
  const std::int64_t points =
      static_cast<std::int64_t>(placed.samples.size()) + options.insertions.value_or(cells) + last;
  return static_cast<std::size_t>(fractal::barycentre_bytes(points, request.draws) + kOthers * cells);
}

Status check_memory(const std::string& method, const PlacedSurvey& placed, const fractal::CellSamples& binned,
                    const fractal::SurfaceRequest& request, const MethodOptions& options) {
  const std::size_t needed = needed_bytes(method, placed, binned, request, options), free = free_memory_bytes();
  if (free == 0 || needed <= free) return {};
  constexpr double kGigabyte = 1e9;
  const auto& [rows, columns, cell_m] = request.grid;
  // Memory goes with the cells, or with the square about the longer side.
  const double share = std::sqrt(static_cast<double>(free) / static_cast<double>(needed));
  return Error{
      ErrorKind::bad_data,
      fmt::format("expected {:.1f} GB of free memory for {} x {} cells, found {:.1f} GB: enough for about {:.0f} "
                  "x {:.0f}; choose larger cells, a smaller --extent, fewer --draws or --insertions",
                  static_cast<double>(needed) / kGigabyte, rows, columns, static_cast<double>(free) / kGigabyte,
                  share * rows, share * columns)};
}

Result<SurfaceEstimate> by_triangles(const std::string& method, const PlacedSurvey& placed,
                                     const fractal::SurfaceRequest& request, const MethodOptions& options,
                                     Executor& executor) {
  if (method == "polyhedron")
    return fractal::reconstruct_polyhedron(placed.samples, request, {.iterations = options.iterations.value_or(0)},
                                           executor);
  const bool corrected = options.barycentre_law == "corrected";
  fractal::BarycentreOptions barycentre = corrected ? fractal::corrected_barycentre() : fractal::BarycentreOptions{};
  barycentre.insertions = options.insertions.value_or(barycentre.insertions);
  if (options.barycentre_law && !corrected) barycentre.law = *barycentre_law(*options.barycentre_law);
  if (options.regions) {
    auto centres = read_regions(*options.regions, placed);
    if (!centres) return centres.error();
    barycentre.centres = *std::move(centres);
  }
  return fractal::reconstruct_barycentre(placed.samples, request, barycentre, executor);
}

Result<SurfaceEstimate> by_posterior(const PlacedSurvey& placed, const fractal::CellSamples& cells,
                                     const fractal::SurfaceRequest& request, const MethodOptions& options,
                                     Executor& executor) {
  fractal::ConditionalOptions conditional;
  conditional.residual_fields = options.fields.value_or(conditional.residual_fields);
  conditional.gate_outliers = !options.keep_outliers;
  conditional.break_edges = options.breaks;
  if (options.ceiling) {
    auto ceiling = read_at_cells(*options.ceiling, placed);
    if (!ceiling) return ceiling.error();
    conditional.ceiling_m = *std::move(ceiling);
  }
  return fractal::reconstruct_conditional(cells, request, conditional, executor);
}

Result<SurfaceEstimate> by_cells(const std::string& method, const fractal::CellSamples& cells,
                                 const fractal::SurfaceRequest& request, const MethodOptions& options,
                                 Executor& executor) {
  if (method == "membrane") return fractal::reconstruct_membrane(cells, request, executor);
  if (method == "thin-plate") return fractal::reconstruct_thin_plate(cells, request, executor);
  if (method == "yokoya") return fractal::reconstruct_yokoya(cells, request, executor);
  if (method == "kriging") return fractal::reconstruct_kriging(cells, request, {}, executor);
  fractal::SzeliskiOptions szeliski;
  if (options.temperature)
    szeliski.temperature = fractal::parse_temperature(*options.temperature).value_or(szeliski.temperature);
  szeliski.sweeps = options.sweeps.value_or(szeliski.sweeps);
  return fractal::reconstruct_szeliski(cells, request, szeliski, executor);
}

}  // namespace

std::vector<std::string> reconstruction_methods() {
  return {"conditional", "szeliski", "polyhedron", "barycentre", "yokoya", "thin-plate", "membrane", "kriging"};
}

Status check_method_options(const std::string& method, const MethodOptions& options) {
  struct Belonging {
    bool given;
    const char *option, *method;
  };
  const Belonging belongings[] = {{options.temperature.has_value(), "--temperature", "szeliski"},
                                  {options.sweeps.has_value(), "--sweeps", "szeliski"},
                                  {options.iterations.has_value(), "--iterations", "polyhedron"},
                                  {options.insertions.has_value(), "--insertions", "barycentre"},
                                  {options.barycentre_law.has_value(), "--barycentre-law", "barycentre"},
                                  {options.regions.has_value(), "--regions", "barycentre"},
                                  {options.fields.has_value(), "--fields", "conditional"},
                                  {options.keep_outliers, "--keep-outliers", "conditional"},
                                  {options.breaks, "--breaks", "conditional"},
                                  {options.ceiling.has_value(), "--ceiling", "conditional"}};
  for (const auto& [given, option, owner] : belongings)
    if (given && method != owner)
      return Error{ErrorKind::usage,
                   fmt::format("{}: expected --method {} beside it, found {}", option, owner, method)};
  if (options.temperature && !fractal::parse_temperature(*options.temperature))
    return Error{ErrorKind::usage,
                 fmt::format("--temperature: expected empirical, formula, closed-form or square metres of at least 0, "
                             "found '{}'",
                             *options.temperature)};
  if (options.barycentre_law && options.barycentre_law != "corrected" && !barycentre_law(*options.barycentre_law))
    return Error{ErrorKind::usage, fmt::format("--barycentre-law: expected published, exact-variance, conditional, "
                                               "neighbours or corrected, found '{}'",
                                               *options.barycentre_law)};
  return {};
}

Result<SurfaceAnswer> reconstruct_surface(const std::string& method, const PlacedSurvey& placed,
                                          const fractal::SurfaceRequest& request, const MethodOptions& options,
                                          Executor& executor) {
  const auto begin = std::chrono::steady_clock::now();
  const bool triangles = method == "polyhedron" || method == "barycentre";
  const fractal::CellSamples cells = fractal::bin_samples(placed.samples, request.grid, request.law);
  if (Status status = check_memory(method, placed, cells, request, options); !status) return status.error();
  auto estimate = triangles                 ? by_triangles(method, placed, request, options, executor)
                  : method == "conditional" ? by_posterior(placed, cells, request, options, executor)
                                            : by_cells(method, cells, request, options, executor);
  if (!estimate) return estimate.error();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  return SurfaceAnswer{*std::move(estimate), cells.cells, taken.count()};
}

}  // namespace scree::node
