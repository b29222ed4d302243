#include "node/reconstruction_law.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "fractal/amplitude.hpp"

namespace scree::node {
namespace {

/// What stands behind --dimension or --amplitude-m.
struct Term {
  enum class Kind : std::uint8_t { automatic, number, raster } kind = Kind::automatic;
  double number = 0.0;
  Grid<float> cells;
};

struct Range {
  double low, high;  ///< exclusive
  const char* text;
};
constexpr Range kDimensions{2.0, 3.0, "a number between 2 and 3"};
constexpr Range kAmplitudes{1e-12, 1e6, "metres above 1e-12 and below 1e6"};

bool inside(double value, const Range& range) {
  return value > range.low && value < range.high;
}

/// A value in range for every cell of the grid.
Result<Grid<float>> read_cells(const std::string& option, const std::string& file, const PlacedSurvey& placed,
                               const Range& range) {
  auto cells = read_at_cells(file, placed);
  if (!cells) return cells;
  for (int r = 0; r < cells->rows(); ++r)
    for (int c = 0; c < cells->columns(); ++c)
      if (const float value = (*cells)(r, c); !inside(static_cast<double>(value), range))
        return Error{ErrorKind::bad_data,
                     fmt::format("{} {}: expected {} at ({:g}, {:g}), found {}", option, file, range.text,
                                 placed.place.raster.x_min_m + (c + 0.5) * placed.grid.cell_m,
                                 placed.place.raster.y_min_m + (r + 0.5) * placed.grid.cell_m,
                                 std::isnan(value) ? "nothing there" : fmt::format("{:g}", value))};
  return cells;
}

Result<Term> read_term(const std::string& option, const std::string& text, const PlacedSurvey& placed,
                       const Range& range) {
  Term term;
  if (text == "auto") return term;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), term.number);
  if (status == std::errc() && end == text.data() + text.size()) {
    term.kind = Term::Kind::number;
    if (inside(term.number, range)) return term;
    return Error{ErrorKind::usage, fmt::format("{}: expected {}, found {}", option, range.text, text)};
  }
  auto cells = read_cells(option, text, placed, range);
  if (!cells) return cells.error();
  term.kind = Term::Kind::raster;
  term.cells = *std::move(cells);
  return term;
}

/// Heights at one place differ by nothing but noise.
void look_at_repeats(const fractal::HeightSamples& samples, SurfaceLaw& law) {
  std::vector<std::size_t> order(samples.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&samples](std::size_t a, std::size_t b) {
    return std::pair(samples.x_m[a], samples.y_m[a]) < std::pair(samples.x_m[b], samples.y_m[b]);
  });
  double sum2_m2 = 0.0;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    double sum = 0.0, sum2 = 0.0;
    const double first = samples.z_m[order[begin]];
    for (; end < order.size() && samples.x_m[order[end]] == samples.x_m[order[begin]] &&
           samples.y_m[order[end]] == samples.y_m[order[begin]];
         ++end) {
      const double z = samples.z_m[order[end]] - first;
      sum += z, sum2 += z * z;
    }
    const auto count = static_cast<double>(end - begin);
    sum2_m2 += sum2 - sum * sum / count;
    law.repeats += end - begin - 1;
  }
  if (law.repeats > 0) law.repeat_sigma_m = std::sqrt(sum2_m2 / static_cast<double>(law.repeats));
}

bool contradicts(const SurfaceLaw& law) {
  const auto degrees = static_cast<double>(law.repeats);
  const double ratio = law.repeat_sigma_m / law.noise_sigma_m;
  return law.repeat_sigma_m > 0.0 && degrees * ratio * ratio > degrees + 4.0 * std::sqrt(2.0 * degrees) + 6.0;
}

/// False where only the amplitude can tell.
Result<bool> find_noise(const SurveyInput& survey, const std::string& text, SurfaceLaw& law) {
  if (text != "auto") {
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), law.noise_sigma_m);
    if (status != std::errc() || end != text.data() + text.size() || !(law.noise_sigma_m >= 0.0) ||
        !std::isfinite(law.noise_sigma_m))
      return Error{ErrorKind::usage, "--noise-sigma-m: expected metres of at least 0, or auto, found '" + text + "'"};
    law.noise_source = NoiseSource::given;
    return true;
  }
  if (law.repeats >= kRepeats && law.repeat_sigma_m > 0.0) {
    law.noise_sigma_m = law.repeat_sigma_m;
    law.noise_source = NoiseSource::repeated;
    return true;
  }
  if (!survey.frames) return false;
  law.noise_sigma_m = survey.frames->noise_sigma_m;
  law.noise_source = NoiseSource::sensor;
  return true;
}

Error give_instead(const Error& error, const char* options) {
  return {error.kind, fmt::format("{}; give {} to go by those", error.message, options)};
}

/// Sets law.found and the D to go by.
Status find_law(const SurveyInput& survey, const LawRequest& request, Executor& executor, SurfaceLaw& law) {
  auto answer = find_dimension(survey, {.noise_sigma_m = law.noise_sigma_m, .seed = request.seed}, executor);
  if (!answer) return give_instead(answer.error(), "--dimension D --amplitude-m A");
  if (!std::isfinite(answer->estimate.dimension))
    return Error{ErrorKind::bad_data,
                 fmt::format("--dimension auto: expected heights that tell D, found a noise of {:g} m that hides it; "
                             "give --dimension D --amplitude-m A to go by those",
                             law.noise_sigma_m)};
  law.map.law = {std::clamp(answer->estimate.dimension, 2.005, 2.995), answer->estimate.amplitude_m};
  law.found = *std::move(answer);
  return {};
}

float median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Files of either kind make the law vary: the other term is then the same in every cell.
void spread(Term dimension, Term amplitude, fractal::LawMap& map) {
  const bool varies = dimension.kind == Term::Kind::raster || amplitude.kind == Term::Kind::raster;
  if (!varies) return;
  const Grid<float>& shape = dimension.kind == Term::Kind::raster ? dimension.cells : amplitude.cells;
  const auto fill = [&shape](Term& term, double value) {
    if (term.kind != Term::Kind::raster) term.cells.assign(shape.rows(), shape.columns(), static_cast<float>(value));
    return std::move(term.cells);
  };
  map.dimension = fill(dimension, map.law.dimension);
  map.amplitude_m = fill(amplitude, map.law.amplitude_m);
  map.law.dimension = static_cast<double>(median({map.dimension.begin(), map.dimension.end()}));
  map.law.amplitude_m = static_cast<double>(median({map.amplitude_m.begin(), map.amplitude_m.end()}));
}

}  // namespace

Result<SurfaceLaw> resolve_law(const SurveyInput& survey, const PlacedSurvey& placed, const LawRequest& request,
                               Executor& executor) {
  auto dimension = read_term("--dimension", request.dimension, placed, kDimensions);
  if (!dimension) return dimension.error();
  auto amplitude = read_term("--amplitude-m", request.amplitude, placed, kAmplitudes);
  if (!amplitude) return amplitude.error();
  if (dimension->kind == Term::Kind::raster && amplitude->kind == Term::Kind::automatic)
    return Error{ErrorKind::usage, "--dimension FILE: expected --amplitude-m A or FILE beside it, found auto"};
  SurfaceLaw law;
  look_at_repeats(placed.samples, law);
  const auto known = find_noise(survey, request.noise, law);
  if (!known) return known.error();
  if (dimension->kind == Term::Kind::automatic)
    if (Status status = find_law(survey, request, executor, law); !status) return status.error();
  if (dimension->kind == Term::Kind::number) law.map.law.dimension = dimension->number;
  if (amplitude->kind == Term::Kind::number) law.map.law.amplitude_m = amplitude->number;
  if (dimension->kind == Term::Kind::number && amplitude->kind == Term::Kind::automatic) {
    const fractal::SurveyPoints points{.x_m = survey.x_m,
                                       .y_m = survey.y_m,
                                       .z_m = survey.z_m,
                                       .noise_sigma_m = law.noise_sigma_m,
                                       .height_resolution_m = survey.height_resolution_m};
    const auto found = fractal::estimate_amplitude(points, dimension->number);
    if (!found) return give_instead(found.error(), "--amplitude-m A");
    law.map.law.amplitude_m = *found;
  }
  spread(*std::move(dimension), *std::move(amplitude), law.map);
  if (!*known) {
    constexpr double kAssumed = 0.01;
    law.noise_sigma_m = kAssumed * law.map.law.rms_change_m(placed.grid.cell_m);
    law.noise_source = NoiseSource::assumed;
  }
  law.contradictory = contradicts(law);
  return law;
}

std::string noise_source_text(NoiseSource source) {
  switch (source) {
    case NoiseSource::given:
      return "given";
    case NoiseSource::repeated:
      return "from repeated samples";
    case NoiseSource::sensor:
      return "of the sensor's model";
    case NoiseSource::assumed:
      return "assumed, 1 % of the change over a cell";
  }
  return "";
}

}  // namespace scree::node
