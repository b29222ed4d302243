#include "io/picture_layout.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <numbers>

namespace scree::io {
namespace {

/// Difference per cell along one axis from what is known on both sides.
double slope(float before, float here, float after) {
  const bool left = std::isfinite(before);
  const bool right = std::isfinite(after);
  if (left && right) return (static_cast<double>(after) - static_cast<double>(before)) / 2.0;
  if (right) return static_cast<double>(after) - static_cast<double>(here);
  if (left) return static_cast<double>(here) - static_cast<double>(before);
  return 0.0;
}

/// The interval of `length` cells around [low, high] within [0, size).
int place(int low, int high, int length, int size) {
  return std::clamp((low + high + 1 - length) / 2, 0, size - length);
}

}  // namespace

CellBlock known_block(const std::vector<const Grid<float>*>& grids) {
  const int rows = grids.front()->rows();
  const int columns = grids.front()->columns();
  int low_row = rows, high_row = -1, low_column = columns, high_column = -1;
  for (const auto* grid : grids) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        if (!std::isfinite((*grid)(r, c))) continue;
        low_row = std::min(low_row, r);
        high_row = std::max(high_row, r);
        low_column = std::min(low_column, c);
        high_column = std::max(high_column, c);
      }
    }
  }
  if (high_row < 0) return {0, 0, rows, columns};
  constexpr int kSmallest = 24;
  const int known = std::max(high_row - low_row, high_column - low_column) + 1;
  const int side = std::max(kSmallest, known + known / 12 + 2);
  CellBlock block{0, 0, std::min(side, rows), std::min(side, columns)};
  block.row = place(low_row, high_row, block.rows, rows);
  block.column = place(low_column, high_column, block.columns, columns);
  return block;
}

Grid<float> cut(const Grid<float>& grid, const CellBlock& block) {
  Grid<float> part(block.rows, block.columns);
  for (int r = 0; r < block.rows; ++r) {
    for (int c = 0; c < block.columns; ++c) part(r, c) = grid(block.row + r, block.column + c);
  }
  return part;
}

std::vector<Tick> ticks(double min, double max, int most) {
  std::vector<Tick> result;
  if (!(max > min) || most < 1) return result;
  const double power = std::pow(10.0, std::floor(std::log10((max - min) / most)));
  double step = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if ((max - min) / (factor * power) <= most) {
      step = factor * power;
      break;
    }
  }
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  for (double i = std::ceil(min / step - 1e-9); i * step <= max + 1e-9 * step; ++i) {
    const double value = i == 0.0 ? 0.0 : i * step;
    result.push_back({value, fmt::format("{:.{}f}", value, decimals)});
  }
  return result;
}

Tick round_length(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  double length = power;
  for (const double factor : {2.0, 5.0}) {
    if (factor * power <= most) length = factor * power;
  }
  return {length,
          fmt::format("{:.{}f}", length, length < 1.0 ? static_cast<int>(std::ceil(-std::log10(length) - 1e-9)) : 0)};
}

std::pair<double, double> value_limits(const Grid<float>& values) {
  std::vector<float> known;
  for (const float value : values) {
    if (std::isfinite(value)) known.push_back(value);
  }
  if (known.empty()) return {0.0, 1.0};
  const auto quantile = [&](double share) {
    const auto at = known.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(known.size() - 1));
    std::nth_element(known.begin(), at, known.end());
    return static_cast<double>(*at);
  };
  const double low = quantile(0.01);
  const double high = quantile(0.99);
  if (high - low > 1e-6 * std::max(1.0, std::abs(high))) return {low, high};
  return {low - 0.05, high + 0.05};
}

Grid<float> hillshade(const Grid<float>& height_m, double cell_m) {
  constexpr double kHalfSqrt2 = std::numbers::sqrt2 / 2;
  const auto at = [&](int r, int c) { return height_m.contains(r, c) ? height_m(r, c) : NAN; };
  Grid<float> brightness(height_m.rows(), height_m.columns(), static_cast<float>(kHalfSqrt2));
  for (int r = 0; r < height_m.rows(); ++r) {
    for (int c = 0; c < height_m.columns(); ++c) {
      const float here = height_m(r, c);
      if (!std::isfinite(here)) continue;
      const double east = slope(at(r, c - 1), here, at(r, c + 1)) / cell_m;
      const double north = slope(at(r - 1, c), here, at(r + 1, c)) / cell_m;
      // light from (−1, 1, √2)/2 on the normal (−east, −north, 1)
      const double lit = (0.5 * east - 0.5 * north + kHalfSqrt2) / std::sqrt(1.0 + east * east + north * north);
      brightness(r, c) = static_cast<float>(std::clamp(lit, 0.0, 1.0));
    }
  }
  return brightness;
}

std::string ascii_text(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
    if (byte < 0x80) {
      result += text[i];
    } else if (byte == 0xC3 && next == 0x97) {
      result += 'x';
    } else if (byte == 0xC2 && next == 0xB1) {
      result += "+-";
    } else if (byte == 0xE2) {
      result += "...";
    }
  }
  return result;
}

}  // namespace scree::io
