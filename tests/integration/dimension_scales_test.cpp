// scree dimension: the distances it prints belong to the D beside them, and a law that does not fit is not believed.

#include <cmath>
#include <gmock/gmock.h>
#include <numbers>

#include "tests/integration/dimension_inputs.hpp"
#include "tests/support/shared_data.hpp"

namespace scree::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// 128 × 128 points of an exact surface, with a wave of `wave_m` along both axes, 12 m long.
std::string wavy_points(const TemporaryFolder& folder, std::uint64_t seed, double wave_m) {
  constexpr int kSide = 128;
  const auto surface = *fractal::fbm_surface({kDimension, kAmplitude}, kSide, kSide, kCell, seed);
  std::ostringstream text;
  text.precision(9);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const double turn = 2.0 * std::numbers::pi * kCell / 12.0;
      text << kCell * c << ' ' << kCell * r << ' ' << surface(r, c) + wave_m * std::sin(turn * c) * std::sin(turn * r)
           << '\n';
    }
  return write(folder, "wavy.xyz", text.str());
}

std::string flags_of(const nlohmann::json& json) {
  return json["flags"].dump();
}

// False alarms: at most one in a thousand each, by the 99.9 % point of a chi-square that theory overstates; fixed
// seeds.
TEST(DimensionScales, OnePowerLawFitsItself) {
  const TemporaryFolder folder;
  for (const std::uint64_t seed : {31, 32, 33}) {
    const auto json = estimate({wavy_points(folder, seed, 0.0)});
    EXPECT_THAT(flags_of(json), Not(HasSubstr("no_law_fits")));
    // Another law is chosen on some percent of pure surfaces (docs/fractal.md); its D may then not be the line's.
    if (json["scales"]["law"] == "power") {
      EXPECT_THAT(flags_of(json), Not(HasSubstr("scale_range_short")));
    }
    EXPECT_GT(json["scales"]["degrees_of_freedom"], 5);
    EXPECT_LT(json["scales"]["chi_square"], 3.0 * json["scales"]["degrees_of_freedom"].get<double>());
    EXPECT_TRUE(json["scales"]["criterion"].contains("power"));
  }
}

TEST(DimensionScales, AWaveOnTheGroundIsNoneOfTheLaws) {
  const TemporaryFolder folder;
  const auto file = wavy_points(folder, 31, 1.0);
  const auto json = estimate({file});
  EXPECT_THAT(flags_of(json), HasSubstr("no_law_fits"));
  EXPECT_THAT(flags_of(json), HasSubstr("scale_range_short"));
  const double spacing = json["spacing_m"];
  EXPECT_NEAR(json["scale_range_m"][0], spacing, 1e-9);
  EXPECT_LT(json["scale_range_m"][1], 3.0 * spacing);  // 13 neighbours: 2.9 of them
  const auto line = scree({"dimension", file});
  EXPECT_THAT(line.out, HasSubstr("(all that D rests on)"));
  EXPECT_THAT(line.err, HasSubstr("no_law_fits: chi-square"));
}

// Smooth between neighbours, rough across the valleys: no law here, and not D = 2.005 over kilometres.
TEST(DimensionScales, ARealDemIsNotOneLawOverKilometres) {
  const auto dem = shared_data("bigtujunga_srtm30/srtm_bigtujunga30m_utm11.tif");
  SCREE_SKIP_WITHOUT(dem, "bigtujunga_srtm30");
  const auto json = estimate({dem->string()});
  EXPECT_THAT(flags_of(json), HasSubstr("no_law_fits"));
  EXPECT_LT(json["scale_range_m"][1], 3.0 * json["spacing_m"].get<double>());
}

TEST(DimensionScales, WithoutADimensionThereIsNoRemarkOnItsScales) {
  const TemporaryFolder folder;
  const auto finished = scree({"dimension", noisy_points(folder, 0.0, 0.0), "--noise-sigma-m", "20"});
  EXPECT_THAT(finished.err, HasSubstr("noise_too_large: the heights show 0.0"));
  for (const char* remark : {"crossover", "plateau", "excess_noise", "no_law_fits"})
    EXPECT_THAT(finished.err, Not(HasSubstr(remark)));
}

// Elevation models whose D stands at the smooth end at their own spacing, and not over all distances.
TEST(DimensionScales, FilledAndResampledModelsAreTooSmoothAtShortDistances) {
  for (const char* name : {"bijou_gully_5m.asc", "pre_runout_10m.asc"}) {
    const auto path = shared_data(std::string("landlab_dems/") + name);
    SCREE_SKIP_WITHOUT(path, "landlab_dems");
    EXPECT_THAT(flags_of(estimate({path->string()})), HasSubstr("smooth_short_lags")) << name;
  }
}

}  // namespace
}  // namespace scree::test
