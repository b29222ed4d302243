#include "fractal/reconstruction/sd_map.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>

#include "fractal/reconstruction/sd_rows.hpp"

namespace scree::fractal {
namespace {

constexpr int kBlock = SdFeatures::kBlock;
constexpr double kRatioReach = 2.0;  // sd of the smoothing over the spacing of the data
constexpr int kMaxRadius = 64;
constexpr double kRidge = 20.0;
constexpr double kFewCells = 32.0;

}  // namespace

void SdMap::fit(const Grid<float>& mean_square_m2, const LawMap& law, double cell_m, Executor& executor) {
  const Grid<std::uint8_t>& measured = features_.measured();
  const int rows = measured.rows(), columns = measured.columns();
  regression_.resize(rows, SdFeatures::terms(law));
  const auto sums = [&](int first, int last) {
    SdFeatures::Block block;
    alignas(64) std::array<float, kBlock> y, weight;
    for (int r = first; r < last; ++r)
      for (int begin = 0; begin < columns; begin += kBlock) {
        features_.load(r, begin, law, cell_m, block);
        sd_rows::log_of(mean_square_m2.row(r).data() + begin, y.data(), block.n);
        sd_rows::add_scaled(block.log_unit2.data(), -1.0F, y.data(), block.n);
        sd_rows::weigh(measured.row(r).data() + begin, weight.data(), block.n);
        std::array<const float*, LogRegression::kMaxTerms - 1> x = {};
        for (std::size_t j = 0; j < x.size(); ++j) x[j] = block.x[j].data();
        regression_.add_row(r, x, y.data(), weight.data(), block.n);
      }
  };
  for_rows(executor, rows, sums);
  // Alone under an open sky the variance grows with distance as the variogram does.
  LogRegression::Coefficients expected = {};
  if (law.varies())
    expected[6] = 2.0;
  else
    expected[1] = 2.0 * law.law.hurst();
  coefficients_ = regression_.fit(expected, kRidge);
}

/// Hardly a cell is unmeasured: v' = level·σ² everywhere, such that Σ of mean squares over variances is the number of
/// cells. Of many cells every n-th decides.
void SdMap::fit_level(const Grid<float>& mean_square_m2, const Grid<float>& variance_m2, const LawMap& law,
                      double cell_m) {
  const int columns = features_.measured().columns();
  const std::size_t step = 1 + mean_square_m2.size() / 4096;
  const auto ratio = [&](double level) {
    double sum = 0.0, n = 0.0;
    for (std::size_t i = 0; i < mean_square_m2.size(); i += step) {
      const auto cell = static_cast<int>(i);
      const double unit = law.at(cell / columns, cell % columns).rms_change_m(cell_m);
      const double alone = level * unit * unit;
      const double v =
          features_.measured()[i] != 0 ? 1.0 / (1.0 / static_cast<double>(variance_m2[i]) + 1.0 / alone) : alone;
      sum += static_cast<double>(mean_square_m2[i]) / v;
      n += 1.0;
    }
    return sum / n;
  };
  double low = std::log(1e-4), high = std::log(1e4);
  for (int pass = 0; pass < 20; ++pass) {
    const double middle = 0.5 * (low + high);
    (ratio(std::exp(middle)) > 1.0 ? low : high) = middle;
  }
  coefficients_ = {0.5 * (low + high)};
}

void SdMap::predict(const Grid<float>& mean_square_m2, const LawMap& law, double cell_m, Executor& executor) {
  const Grid<std::uint8_t>& measured = features_.measured();
  const int rows = measured.rows(), columns = measured.columns();
  ratio_.resize(rows, columns, std::min(BoxCascade::radius_of(kRatioReach * features_.spacing_cells()), kMaxRadius));
  const auto pass = [&](int first, int last) {
    SdFeatures::Block block;
    for (int r = first; r < last; ++r) {
      double sum = 0.0;
      for (int begin = 0; begin < columns; begin += kBlock) {
        features_.load(r, begin, law, cell_m, block);
        float* model = model_m2_.row(r).data() + begin;
        for (int i = 0; i < block.n; ++i)
          model[i] = static_cast<float>(coefficients_[0]) + block.log_unit2[static_cast<std::size_t>(i)];
        for (std::size_t j = 1; j < static_cast<std::size_t>(block.terms); ++j)
          sd_rows::add_scaled(block.x[j - 1].data(), static_cast<float>(coefficients_[j]), model, block.n);
        sd_rows::exp_in_place(model, block.n);
        float* ratio = ratio_.row(r).data() + begin;
        sd_rows::ratio_row(measured.row(r).data() + begin, mean_square_m2.row(r).data() + begin, model, ratio, block.n);
        for (int i = 0; i < block.n; ++i) sum += static_cast<double>(ratio[i]);
      }
      row_ratio_[static_cast<std::size_t>(r)] = sum;
    }
  };
  for_rows(executor, rows, pass);
}

void SdMap::smooth_ratio(bool level_known) {
  const Grid<std::uint8_t>& measured = features_.measured();
  double sum = 0.0;
  for (const double row : row_ratio_) sum += row;
  mean_ratio_ = level_known ? 1.0 : sum / (static_cast<double>(measured.size()) - features_.measured_cells());
  for (int r = 0; r < measured.rows(); ++r) {  // measured cells say nothing for or against the model
    const auto ratio = ratio_.row(r);
    for (int c = 0; c < measured.columns(); ++c)
      if (measured(r, c) != 0) ratio[static_cast<std::size_t>(c)] = static_cast<float>(mean_ratio_);
  }
  ratio_.smooth();
}

void SdMap::correct(int fields, Executor& executor) {
  const int columns = model_m2_.columns();
  const auto mean = static_cast<float>(mean_ratio_);
  const float share = 1.0F / (1.0F + 8.0F / static_cast<float>(fields));
  const auto pass = [&](int first, int last) {
    for (int r = first; r < last; ++r) {
      sd_rows::correct_row(ratio_.smoothed(r).data(), ratio_.weight_of_columns().data(), ratio_.weight_of_row(r), mean,
                           share, model_m2_.row(r).data(), columns);
    }
  };
  for_rows(executor, model_m2_.rows(), pass);
}

void SdMap::inflate(const Grid<float>& factor, const Grid<float>& variance_m2, Grid<float>& sd_m) const {
  assert(factor.rows() == model_m2_.rows() && factor.columns() == model_m2_.columns());
  if (features_.measured_cells() < 1.0) return;
  std::vector<float> alone(static_cast<std::size_t>(factor.columns()));
  for (int r = 0; r < factor.rows(); ++r) {
    for (int c = 0; c < factor.columns(); ++c) alone[static_cast<std::size_t>(c)] = model_m2_(r, c) * factor(r, c);
    sd_rows::write_row(variance_m2.row(r).data(), alone.data(), sd_m.row(r).data(), factor.columns());
  }
}

void SdMap::estimate(const Grid<float>& mean_square_m2, int fields, const Grid<float>& variance_m2, const LawMap& law,
                     double cell_m, Executor& executor, Grid<float>& sd_m) {
  const int rows = variance_m2.rows(), columns = variance_m2.columns();
  assert(mean_square_m2.rows() == rows && mean_square_m2.columns() == columns && fields >= 1);
  sd_m.assign(rows, columns, std::numeric_limits<float>::quiet_NaN());
  features_.measure(variance_m2, executor);
  if (features_.measured_cells() < 1.0) return;
  if (law.varies()) features_.measure_law(law, cell_m, executor);
  if (model_m2_.rows() != rows || model_m2_.columns() != columns) {
    model_m2_.assign(rows, columns, 0.0F);
    row_ratio_.assign(static_cast<std::size_t>(rows), 0.0);
  }
  const bool few = static_cast<double>(variance_m2.size()) - features_.measured_cells() < kFewCells;
  if (few)
    fit_level(mean_square_m2, variance_m2, law, cell_m);
  else
    fit(mean_square_m2, law, cell_m, executor);
  predict(mean_square_m2, law, cell_m, executor);
  smooth_ratio(few);
  correct(fields, executor);
  const auto write = [&](int first, int last) {
    for (int r = first; r < last; ++r)
      sd_rows::write_row(variance_m2.row(r).data(), model_m2_.row(r).data(), sd_m.row(r).data(), columns);
  };
  for_rows(executor, rows, write);
}

}  // namespace scree::fractal
