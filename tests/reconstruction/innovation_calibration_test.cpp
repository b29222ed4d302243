#include "fractal/reconstruction/innovation_calibration.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// χ²₁ times `truth` at a share `density` of the cells, of world cells (x, y) and frame.
Grid<float> heard(const LatticeWindow& window, double density, double truth, std::uint64_t frame) {
  Grid<float> ratio(window.rows, window.columns, kNaN);
  for (int r = 0; r < window.rows; ++r)
    for (int c = 0; c < window.columns; ++c) {
      const int x = window.min.x + c, y = window.min.y + r;
      if (to_uniform(random_words(3, 2 * frame, x, y)[0]) < density)
        ratio(r, c) = static_cast<float>(truth * std::pow(random_normals(3, 2 * frame + 1, x, y)[0], 2));
    }
  return ratio;
}

Grid<float> silence(const LatticeWindow& window) {
  return Grid<float>(window.rows, window.columns, kNaN);
}

const LatticeWindow kWindow{{-40, 7}, 96, 128};
constexpr double kKappa = 0.99501;  // E min(χ²₁, 9) = 1 − erfc(3/√2) − 6·φ(3) + 9·erfc(3/√2)

TEST(InnovationCalibration, WithoutNewsTheLawIsBelieved) {
  InnovationCalibration calibration;
  EXPECT_TRUE(calibration.factor().empty());
  SerialExecutor serial;
  calibration.update(kWindow, silence(kWindow), serial);
  EXPECT_EQ(calibration.factor(), Grid<float>(96, 128, 1.0F));
  EXPECT_EQ(calibration.window(), kWindow);
}

/// Three sums over 5 cells in a row of n, one after the other.
Eigen::MatrixXd three_boxes(int n) {
  Eigen::MatrixXd box = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = std::max(i - 2, 0); j <= std::min(i + 2, n - 1); ++j) box(i, j) = 1.0;
  return box * box * box;
}

// Every term by hand, borders and a second frame included.
TEST(InnovationCalibration, IsThePosteriorMeanOverTheWindow) {
  const InnovationConfig config{.window_cells = 2.0, .prior_cells = 10.0, .memory_frames = 5.0};
  InnovationCalibration calibration(config);
  SerialExecutor serial;
  const LatticeWindow window{{0, 0}, 20, 23};
  const Grid<float> first = heard(window, 0.3, 1.0, 1), second = heard(window, 0.1, 1.0, 2);
  calibration.update(window, first, serial);
  const Grid<float> before = calibration.factor();
  calibration.update(window, second, serial);

  // Three boxes of 5 cells in a line, each cut at the border; the scale is that of a line without ends.
  const Eigen::MatrixXd down = three_boxes(window.rows), along = three_boxes(window.columns), open = three_boxes(99);
  const double scale = std::pow(open.col(49).sum() / open.col(49).squaredNorm(), 2);
  for (int r = 0; r < window.rows; ++r)
    for (int c = 0; c < window.columns; ++c) {
      double above = 10.0, below = 10.0;
      for (int y = 0; y < window.rows; ++y)
        for (int x = 0; x < window.columns; ++x)
          for (int frame = 0; frame < 2; ++frame) {
            const float ratio = frame == 0 ? first(y, x) : second(y, x);
            if (std::isnan(ratio)) continue;
            const double most = frame == 0 ? 9.0 : 9.0 * std::max(1.0, static_cast<double>(before(y, x)));
            const double w = scale * down(r, y) * along(c, x) * (frame == 0 ? std::exp(-0.2) : 1.0);
            above += w * std::min(static_cast<double>(ratio), most) / kKappa;
            below += w;
          }
      ASSERT_NEAR(calibration.factor()(r, c), above / below, 2e-5) << r << " " << c;
    }
}

// (Σg)²/Σg² of three boxes of 17 cells each way: (17/(11/20))² = 955 (a Gaussian of their sd, 8.49, would count
// 4π·8.49² = 905). q = (10 + 2n/κ)/(10 + n) of twos gives n. The spline's 11/20 is exact to 1/17² of itself.
constexpr double kCells = 955.0;
TEST(InnovationCalibration, CountsAnEffectiveNumberOfCells) {
  SerialExecutor serial;
  const LatticeWindow window{{0, 0}, 120, 120};
  InnovationCalibration calibration;
  calibration.update(window, Grid<float>(120, 120, 2.0F), serial);
  const double q = static_cast<double>(calibration.factor()(60, 60));
  const double n = (10.0 * q - 10.0) / (2.0 / kKappa - q);
  EXPECT_NEAR(n / kCells, 1.0, 0.004);
}

// The variance of the mean of n χ²₁ is 2/n (1.92/n with the limit at 9: E min(χ²,9)² − κ² = 1.901, over κ²), so that
// of q is that times (n/(10 + n))². 24 frames of 200² cells at 15 %: 25 places a frame that are 40 cells (4.7 sd)
// apart, 600 values: the sample variance has a relative sd of √(2/600) = .058 and their mean one of √(1.92/n)/√600 =
// .0045. At 4.4 sd the false alarm rate is 1e-5 each.
TEST(InnovationCalibration, ErrsAsMuchAsThatNumberSays) {
  SerialExecutor serial;
  const LatticeWindow window{{0, 0}, 200, 200};
  const double n = 0.15 * kCells, share = n / (10.0 + n);
  double sum = 0.0, square = 0.0;
  for (std::uint64_t frame = 0; frame < 24; ++frame) {
    InnovationCalibration calibration;
    calibration.update(window, heard(window, 0.15, 1.0, frame), serial);
    for (int r = 20; r < 200; r += 40)
      for (int c = 20; c < 200; c += 40) {
        const double error = static_cast<double>(calibration.factor()(r, c)) - 1.0;
        sum += error;
        square += error * error;
      }
  }
  EXPECT_NEAR(sum / 600.0, 0.0, 4.4 * 0.0045);
  EXPECT_NEAR(square / 600.0 / (1.92 / n * share * share), 1.0, 4.4 * 0.058 + 0.05);  // .05: the border of the outer 20
}

TEST(InnovationCalibration, OneWildCellWidensItsSurroundingsByHalfAtMost) {
  for (const float wild : {1e3F, 1e30F, std::numeric_limits<float>::infinity()}) {
    InnovationCalibration calibration;
    SerialExecutor serial;
    Grid<float> ratio = silence(kWindow);
    ratio(50, 60) = wild;
    calibration.update(kWindow, ratio, serial);
    for (const float q : calibration.factor()) {
      ASSERT_GE(q, 1.0F);
      ASSERT_LT(std::sqrt(q), 1.55F);
    }
    EXPECT_EQ(calibration.factor()(50, 20), 1.0F);  // out of reach
  }
}

// 3 % of the cells a frame, each frame counts e^(−1/20) less: after 40 frames .03·(1 − e^−2)/(1 − e^(−1/20)) = .53 of
// the cells, n = 506, and the prior pulls by 10/516 of the way to 1. sd of q/truth: √(1.92/506) = .062, a little more
// for ages count unequally; 5 sd.
TEST(InnovationCalibration, FindsALawThatIsWrongByAnyFactor) {
  for (const double truth : {0.1, 0.5, 1.0, 4.0, 25.0, 400.0}) {
    InnovationCalibration calibration;
    SerialExecutor serial;
    for (std::uint64_t frame = 0; frame < 40; ++frame)
      calibration.update(kWindow, heard(kWindow, 0.03, truth, frame), serial);
    const double expected = (10.0 + 506.0 * truth) / 516.0;
    EXPECT_NEAR(calibration.factor()(48, 64) / expected, 1.0, 5.0 * 0.062) << truth;
  }
}

TEST(InnovationCalibration, ForgetsWithTheFrames) {
  InnovationCalibration calibration;
  SerialExecutor serial;
  calibration.update(kWindow, Grid<float>(96, 128, 4.0F), serial);
  const auto evidence = [&] {  // n of q = (10 + n·4/κ)/(10 + n)
    const double q = static_cast<double>(calibration.factor()(48, 64));
    return 10.0 * (q - 1.0) / (4.0 / kKappa - q);
  };
  const double fresh = evidence();
  for (int frame = 0; frame < 60; ++frame) calibration.update(kWindow, silence(kWindow), serial);
  EXPECT_NEAR(evidence() / fresh, std::exp(-3.0), 1e-3);
}

// Beliefs belong to the ground: what stays in the window stays, bit for bit as if the rest had never been heard of.
TEST(InnovationCalibration, MovesWithTheGround) {
  SerialExecutor serial;
  const Grid<float> news = heard(kWindow, 0.2, 3.0, 1);
  for (const auto& [dx, dy, rows, columns] : {std::array{5, 0, 96, 128},
                                              {-3, 2, 96, 128},
                                              {0, -90, 96, 128},
                                              {17, 11, 96, 128},
                                              {200, 0, 96, 128},
                                              {-4, 6, 60, 150}}) {
    const LatticeWindow moved{{kWindow.min.x + dx, kWindow.min.y + dy}, rows, columns};
    InnovationCalibration calibration;
    calibration.update(kWindow, news, serial);
    calibration.update(moved, silence(moved), serial);
    Grid<float> kept = silence(moved);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c)
        if (news.contains(r + dy, c + dx)) kept(r, c) = news(r + dy, c + dx);
    InnovationCalibration fresh;
    fresh.update(moved, kept, serial);
    fresh.update(moved, silence(moved), serial);
    EXPECT_EQ(calibration.factor(), fresh.factor()) << dx << " " << dy;
  }
}

TEST(InnovationCalibration, WhereTheWindowStandsDoesNotMatterNorDoThreads) {
  class Pieces final : public Executor {
    void for_ranges(int count, const std::function<void(int, int)>& body) override {
      for (int i = count; i > 0; i -= 7) body(std::max(i - 7, 0), i);
    }
  } pieces;
  SerialExecutor serial;
  InnovationCalibration here, there;
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    const int step = static_cast<int>(frame) * 3;
    const LatticeWindow window{{step, -step}, 70, 90};
    const LatticeWindow far{{2'000'000'000 + step, -2'000'000'000 - step}, 70, 90};
    const Grid<float> news = heard(window, 0.1, 2.0, frame);
    here.update(window, news, serial);
    there.update(far, news, pieces);
    EXPECT_EQ(here.factor(), there.factor());
  }
  // From one end of the lattice to the other: nothing in common, and no overflow.
  const LatticeWindow end{{-2'000'000'000, 2'000'000'000}, 70, 90};
  there.update(end, silence(end), pieces);
  EXPECT_EQ(there.factor(), Grid<float>(70, 90, 1.0F));
}

}  // namespace
}  // namespace scree::fractal
