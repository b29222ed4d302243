#include "fractal/reconstruction/kriging.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "core/random.hpp"
#include "fractal/reconstruction/intrinsic_kriging.hpp"
#include "fractal/reconstruction/surface_checks.hpp"
#include "fractal/reconstruction/unconditional_fields.hpp"

namespace scree::fractal {
namespace {

constexpr std::uint64_t kNoiseStream = 0x6b726967696e672d;  // "kriging-"
constexpr int kDrawBatch = 4;

/// The measured cells, heights in units of `unit_m` less `offset_m`.
struct Data {
  std::vector<CellIndex> places;
  std::vector<double> noise;
  Eigen::VectorXd heights;
  double unit_m = 1.0, offset_m = 0.0;
};

Data data_of(const CellSamples& samples, double unit_m) {
  Data data;
  data.unit_m = unit_m;
  std::vector<double> heights;
  for (int r = 0; r < samples.height_m.rows(); ++r)
    for (int c = 0; c < samples.height_m.columns(); ++c) {
      if (std::isnan(samples.height_m(r, c))) continue;
      data.places.push_back({c, r});
      data.noise.push_back(static_cast<double>(samples.variance_m2(r, c)) / (unit_m * unit_m));
      heights.push_back(static_cast<double>(samples.height_m(r, c)));
      data.offset_m += heights.back();
    }
  data.offset_m /= static_cast<double>(heights.size());
  data.heights =
      (Eigen::Map<Eigen::VectorXd>(heights.data(), static_cast<Eigen::Index>(heights.size())).array() - data.offset_m) /
      unit_m;
  return data;
}

Status check_size(std::size_t measured, std::size_t cells, const KrigingOptions& options) {
  if (measured > options.max_samples)
    return Error{ErrorKind::usage, fmt::format("kriging: expected at most {} measured cells (it is dense), found {}",
                                               options.max_samples, measured)};
  const std::size_t bytes = measured * measured * 8 + measured * 8 * 16 * IntrinsicKriging::kBlock + cells * 48;
  if (bytes > options.max_bytes)
    return Error{ErrorKind::usage,
                 fmt::format("kriging: expected to fit in {} MB, found {} measured cells in {} cells, which need {} MB",
                             options.max_bytes >> 20, measured, cells, bytes >> 20)};
  return {};
}

class Prediction {
 public:
  Prediction(const SurfaceRequest& request, const Data& data, const IntrinsicKriging& kriging, Executor& executor)
      : request_(request), data_(data), kriging_(kriging), executor_(executor) {}

  /// Kriging of one set of weights plus `base` (in units, may be null), metres.
  void evaluate(const IntrinsicKriging::Weights& weights, Eigen::Index set, const Grid<float>* base,
                Grid<float>& out_m) const {
    executor_.for_ranges(out_m.rows(), [&](int begin, int end) {
      std::vector<double> line(static_cast<std::size_t>(out_m.columns()));
      for (int r = begin; r < end; ++r) {
        kriging_.mean_row(weights, set, r, line.data());
        for (int c = 0; c < out_m.columns(); ++c) {
          const double extra = base == nullptr ? 0.0 : static_cast<double>((*base)(r, c));
          out_m(r, c) = static_cast<float>(data_.offset_m + data_.unit_m * (line[static_cast<std::size_t>(c)] + extra));
        }
      }
    });
  }

  /// Rows at a time, so that progress can be told.
  Grid<float> deviations(double from, double to) const {
    const auto [rows, columns] = std::pair{request_.grid.rows, request_.grid.columns};
    Grid<float> sd_m(rows, columns);
    constexpr int kRows = 8;
    for (int first = 0; first < rows; first += kRows) {
      const int here = std::min(kRows, rows - first) * columns;
      executor_.for_ranges(here, [&, columns_here = columns](int begin, int end) {
        std::vector<CellIndex> cells;
        for (int i = begin; i < end; ++i) cells.push_back({i % columns_here, first + i / columns_here});
        std::vector<double> sd(cells.size());
        kriging_.deviations(cells, sd.data());
        for (std::size_t i = 0; i < cells.size(); ++i)
          sd_m(cells[i].y, cells[i].x) = static_cast<float>(data_.unit_m * sd[i]);
      });
      tell(from + (to - from) * std::min(1.0, static_cast<double>(first + kRows) / rows));
    }
    return sd_m;
  }

  /// u + kriging of (data − u at the data − noise): Matheron's rule.
  void draw(const UnconditionalFields& fields, double from) const {
    const auto n = static_cast<Eigen::Index>(data_.places.size());
    Grid<float> out_m(request_.grid.rows, request_.grid.columns);
    for (int first = 0; first < request_.draws; first += kDrawBatch) {
      const int here = std::min(kDrawBatch, request_.draws - first);
      std::vector<Grid<float>> surfaces(static_cast<std::size_t>(here));
      Eigen::MatrixXd sets(n, here);
      executor_.for_ranges(here, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
          Grid<float>& u = surfaces[static_cast<std::size_t>(k)];
          u = fields.field(request_.seed, first + k);
          for (Eigen::Index i = 0; i < n; ++i) sets(i, k) = data_.heights(i) - disturbed(u, i, first + k);
        }
      });
      const IntrinsicKriging::Weights weights = kriging_.weights_of(sets);
      for (int k = 0; k < here; ++k) {
        evaluate(weights, k, &surfaces[static_cast<std::size_t>(k)], out_m);
        if (request_.on_draw) request_.on_draw(first + k, out_m);
        tell(from + (1.0 - from) * (first + k + 1) / request_.draws);
      }
    }
  }

 private:
  void tell(double share) const {
    if (request_.on_progress) request_.on_progress(share);
  }
  double disturbed(const Grid<float>& u, Eigen::Index i, int k) const {
    const auto at = static_cast<std::size_t>(i);
    const CellIndex place = data_.places[at];
    const double normal =
        random_normals(request_.seed, kNoiseStream + static_cast<std::uint64_t>(k), place.x, place.y)[0];
    return static_cast<double>(u(place.y, place.x)) + std::sqrt(data_.noise[at]) * normal;
  }

  const SurfaceRequest& request_;
  const Data& data_;
  const IntrinsicKriging& kriging_;
  Executor& executor_;
};

}  // namespace

Result<SurfaceEstimate> reconstruct_kriging(const CellSamples& samples, const SurfaceRequest& request,
                                            const KrigingOptions& options, Executor& executor) {
  if (Status status = check_surface("kriging", samples, request); !status) return status.error();
  if (Status status = check_one_law("kriging", request.law); !status) return status.error();
  const FractalLaw& law = request.law.law;
  const Data data = data_of(samples, law.rms_change_m(request.grid.cell_m));
  if (Status status = check_size(data.places.size(), samples.height_m.size(), options); !status) return status.error();
  const auto fields =
      UnconditionalFields::make(std::clamp(law.hurst(), 0.05, 0.95), request.grid.rows, request.grid.columns);
  if (!fields) return Error{fields.error().kind, "kriging: " + fields.error().message};
  const auto kriging =
      IntrinsicKriging::make(law.hurst(), request.grid.rows, request.grid.columns, data.places, data.noise);
  if (!kriging) return kriging.error();

  const Prediction prediction(request, data, *kriging, executor);
  SurfaceEstimate estimate;
  estimate.mean_m.assign(request.grid.rows, request.grid.columns, 0.0F);
  prediction.evaluate(kriging->weights_of(data.heights), 0, nullptr, estimate.mean_m);
  constexpr double kShareOfDeviations = 0.9;
  estimate.sd_m = prediction.deviations(0.0, request.draws > 0 ? kShareOfDeviations : 1.0);
  if (request.draws > 0) prediction.draw(*fields, kShareOfDeviations);
  return estimate;
}

}  // namespace scree::fractal
