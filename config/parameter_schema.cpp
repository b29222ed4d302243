#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <initializer_list>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/key_types.hpp"
#include "config/sensor_schema.hpp"
#include "config/values.hpp"

namespace scree::config {

const std::vector<std::pair<std::string, ProjectionKind>>& projections() {
  using Kind = ProjectionKind;
  static const std::vector<std::pair<std::string, Kind>> words{{"perceptron_usf", Kind::perceptron_usf},
                                                               {"perceptron_cmu", Kind::perceptron_cmu},
                                                               {"spherical", Kind::spherical},
                                                               {"pinhole", Kind::pinhole},
                                                               {"cloud", Kind::cloud}};
  return words;
}

namespace {

using Kind = ProjectionKind;
using Params = ProjectionConfig;

/// Makes `key` apply to some projections only.
Key<Params> only_for(std::initializer_list<Kind> kinds, Key<Params> key) {
  const std::vector<Kind> allowed(kinds);
  std::string names;
  for (const auto& [word, kind] : projections()) {
    if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) names += (names.empty() ? "" : " or ") + word;
  }
  key.applies_to = kinds.size() + 1 == projections().size() ? "any projection but cloud" : "projection " + names;
  key.applies = [allowed](const Params& params) {
    return std::find(allowed.begin(), allowed.end(), params.kind) != allowed.end();
  };
  return key;
}

/// "default" or [horizontal, vertical], which is stored as {H, V}.
Key<Params> field_of_view() {
  Key<Params> key{"field_of_view_rad",
                  "default or [horizontal, vertical], each above 0, below pi",
                  {},
                  {},
                  {},
                  {},
                  nullptr,
                  {},
                  false};
  key.doc = "Whole field of view; `default` is the published one.";
  key.read = [](const YamlNode& node, Params& params) {
    if (read_text(node) == "default") return params.field_of_view_rad = {0.0, 0.0}, true;
    const auto values = read_numbers(node);
    if (!values || values->size() != 2) return false;
    for (const double value : *values) {
      if (!(value > 0.0 && value < std::numbers::pi)) return false;
    }
    params.field_of_view_rad = {(*values)[0], (*values)[1]};
    return true;
  };
  key.write = [](const Params& params) {
    const auto& field = params.field_of_view_rad;
    return field[0] == 0.0 ? std::string("default") : write_numbers({field[0], field[1]});
  };
  key.copy = [](const Params& from, Params& to) { to.field_of_view_rad = from.field_of_view_rad; };
  return key;
}

Key<Params> angles(std::string name, Lens<Params, std::vector<double>> lens, double limit_rad, std::string doc) {
  Key<Params> key{std::move(name),
                  fmt::format("a list of 1 to 4096 angles within ±{:.6g}", limit_rad),
                  std::move(doc),
                  {},
                  {},
                  {},
                  nullptr,
                  {},
                  false};
  key.read = [lens, limit_rad](const YamlNode& node, Params& params) {
    auto values = read_numbers(node);
    if (!values || values->empty() || values->size() > 4096) return false;
    for (const double value : *values) {
      if (value < -limit_rad || value > limit_rad) return false;
    }
    lens(params) = *std::move(values);
    return true;
  };
  key.write = [lens](const Params& params) { return write_numbers(view(lens, params)); };
  set_copy(key, lens);
  return key;
}

void add_image_keys(Schema<Params>& schema) {
  const Bounds size{1, 4096, false};
  schema.keys.push_back(
      only_for({Kind::perceptron_usf, Kind::perceptron_cmu, Kind::spherical, Kind::pinhole},
               integer<Params, int>("rows", [](Params& p) -> int& { return p.rows; }, size,
                                    "Image height; `default` takes it from the first frame.", {"default", 0})));
  schema.keys.push_back(
      only_for({Kind::perceptron_usf, Kind::perceptron_cmu, Kind::spherical, Kind::pinhole},
               integer<Params, int>("columns", [](Params& p) -> int& { return p.columns; }, size,
                                    "Image width; `default` takes it from the first frame.", {"default", 0})));
  schema.keys.push_back(
      only_for({Kind::perceptron_usf, Kind::perceptron_cmu, Kind::spherical, Kind::pinhole},
               integer<Params, int>("trusted_rows", [](Params& p) -> int& { return p.trusted_rows; }, {0, 4096, false},
                                    "Rows from the top whose ranges are used; `default` is all but the last four of a "
                                    "512-row Perceptron image, all elsewhere.",
                                    {"default", -1})));
  schema.keys.push_back(
      only_for({Kind::perceptron_usf, Kind::perceptron_cmu, Kind::spherical, Kind::pinhole},
               integer<Params, std::int64_t>("invalid_raw", [](Params& p) -> std::int64_t& { return p.invalid_raw; },
                                             {0, 65535, false}, "Raw count that means: no return.", {"none", -1})));
}

void add_perceptron_keys(Schema<Params>& schema) {
  auto shift = choice<Params, int>(
      "reflectance_shift", [](Params& p) -> int& { return p.reflectance_shift; }, {{"none", 0}, {"12", 12}, {"16", 16}},
      "Bit where the reflectance starts in a word; the range does not depend on it.");
  schema.keys.push_back(only_for({Kind::perceptron_usf, Kind::perceptron_cmu}, std::move(shift)));
  schema.keys.push_back(
      only_for({Kind::perceptron_usf}, flag<Params>(
                                           "lenient", [](Params& p) -> bool& { return p.lenient; },
                                           "Take a payload that lies at the end of the file behind up to 4096 bytes of "
                                           "surplus text, with a warning.")));
  schema.keys.push_back(
      only_for({Kind::perceptron_usf}, number<Params>(
                                           "unit_m", [](Params& p) -> double& { return p.unit_m; }, {0, 10, true},
                                           "Metres per length unit of the published constants.")));
  schema.keys.push_back(only_for({Kind::perceptron_usf, Kind::perceptron_cmu}, field_of_view()));
}

void add_range_keys(Schema<Params>& schema) {
  schema.keys.push_back(only_for(
      {Kind::perceptron_usf, Kind::perceptron_cmu, Kind::spherical},
      number<Params>("range_per_count_m", [](Params& p) -> double& { return p.range_per_count_m; }, {0, 10, true},
                     "Metres per count; `default` is the published one, spherical has none.", {"default", 0.0})));
  schema.keys.push_back(only_for({Kind::perceptron_cmu, Kind::spherical},
                                 number<Params>(
                                     "range_offset_m", [](Params& p) -> double& { return p.range_offset_m; },
                                     {-100, 100, false}, "Range at count 0.")));
  schema.keys.push_back(
      only_for({Kind::perceptron_usf, Kind::perceptron_cmu, Kind::spherical, Kind::pinhole},
               number<Params>("ambiguity_m", [](Params& p) -> double& { return p.ambiguity_m; }, {0, 1e4, false},
                              "Phase interval; 0 is unambiguous, `default` the projection's own.", {"default", -1.0})));
}

void add_pinhole_keys(Schema<Params>& schema) {
  const auto add = [&](const char* name, Lens<Params, double> lens, const Bounds& bounds, const char* doc) {
    schema.keys.push_back(only_for({Kind::pinhole}, number<Params>(name, std::move(lens), bounds, doc)));
  };
  add(
      "fx_px", [](Params& p) -> double& { return p.fx_px; }, {0, 1e5, true}, "Focal length. Required for pinhole.");
  add(
      "fy_px", [](Params& p) -> double& { return p.fy_px; }, {0, 1e5, true}, "Focal length. Required for pinhole.");
  add(
      "cx_px", [](Params& p) -> double& { return p.cx_px; }, {-1e5, 1e5, false}, "Principal point.");
  add(
      "cy_px", [](Params& p) -> double& { return p.cy_px; }, {-1e5, 1e5, false}, "Principal point.");
  add(
      "depth_unit_m", [](Params& p) -> double& { return p.depth_unit_m; }, {0, 1, true},
      "Metres of depth per count; count 0 is no return.");
}

void add_spherical_keys(Schema<Params>& schema) {
  schema.keys.push_back(
      only_for({Kind::spherical},
               angles(
                   "row_elevations_rad", [](Params& p) -> std::vector<double>& { return p.row_elevations_rad; },
                   std::numbers::pi / 2, "One per row, up positive, top row first. Required for spherical.")));
  schema.keys.push_back(
      only_for({Kind::spherical},
               angles(
                   "column_azimuths_rad", [](Params& p) -> std::vector<double>& { return p.column_azimuths_rad; },
                   2 * std::numbers::pi, "One per column, left positive. Required for spherical.")));
}

/// What a projection cannot do without.
std::optional<Contradiction> check_pinhole(const Params& p) {
  if (p.kind != Kind::pinhole || (p.fx_px > 0.0 && p.fy_px > 0.0)) return std::nullopt;
  return Contradiction{"parameters.fx_px and fy_px with projection pinhole",
                       fmt::format("fx_px {}, fy_px {}", p.fx_px, p.fy_px)};
}

std::optional<Contradiction> check_spherical(const Params& p) {
  const bool whole = !p.row_elevations_rad.empty() && !p.column_azimuths_rad.empty() && p.range_per_count_m > 0.0;
  if (p.kind != Kind::spherical || whole) return std::nullopt;
  return Contradiction{
      "parameters.row_elevations_rad, column_azimuths_rad and range_per_count_m with projection spherical",
      fmt::format("{} elevations, {} azimuths, {} m per count", p.row_elevations_rad.size(),
                  p.column_azimuths_rad.size(), p.range_per_count_m)};
}

std::optional<Contradiction> check_spherical_size(const Params& p) {
  const auto contradicts = [](int size, std::size_t given) {
    return size != 0 && given != 0 && size != static_cast<int>(given);
  };
  if (p.kind != Kind::spherical) return std::nullopt;
  if (!contradicts(p.rows, p.row_elevations_rad.size()) && !contradicts(p.columns, p.column_azimuths_rad.size()))
    return std::nullopt;
  return Contradiction{"an elevation for each row and an azimuth for each column",
                       fmt::format("{} × {} for {} × {} pixels", p.row_elevations_rad.size(),
                                   p.column_azimuths_rad.size(), p.rows, p.columns)};
}

}  // namespace

Schema<Params> parameter_schema() {
  Schema<Params> schema;
  add_image_keys(schema);
  add_perceptron_keys(schema);
  add_range_keys(schema);
  add_pinhole_keys(schema);
  add_spherical_keys(schema);
  schema.rules.push_back({{"fx_px", "fy_px"}, check_pinhole});
  schema.rules.push_back({{"row_elevations_rad", "column_azimuths_rad", "range_per_count_m"}, check_spherical});
  schema.rules.push_back({{"rows", "columns", "row_elevations_rad", "column_azimuths_rad"}, check_spherical_size});
  schema.rules.push_back(
      {{"trusted_rows", "rows"}, [](const Params& p) -> std::optional<Contradiction> {
         if (p.rows == 0 || p.trusted_rows <= p.rows) return std::nullopt;
         return Contradiction{fmt::format("at most the {} rows there are", p.rows), std::to_string(p.trusted_rows)};
       }});
  return schema;
}

}  // namespace scree::config
