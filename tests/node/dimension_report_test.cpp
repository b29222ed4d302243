#include "node/dimension_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scree::node {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// A report and what it refers to.
struct Case {
  SurveyInput input;
  DimensionRequest request;
  DimensionAnswer answer;
  std::optional<fractal::Anisotropy> anisotropy;
  DimensionReport report() const { return {input, request, answer, anisotropy, {}}; }
};

Case stretched(double strength) {
  Case made;
  made.answer.estimate.dimension = 2.4;
  made.anisotropy.emplace();
  made.anisotropy->significant = true;
  made.anisotropy->p_value = 1e-9;
  made.anisotropy->strength = strength;
  return made;
}

TEST(DimensionReport, AStretchOfAFewPercentIsSaidAndNotFlagged) {
  const Case a = stretched(1.09), b = stretched(1.11);
  const DimensionReport little = a.report(), much = b.report();
  EXPECT_THAT(all_flags(little), Not(Contains("anisotropic")));
  EXPECT_THAT(dimension_line(little), HasSubstr("nearly isotropic, stretched 1.09 times (p = 1e-09)"));
  EXPECT_THAT(all_flags(much), Contains("anisotropic"));
  EXPECT_THAT(dimension_line(much), HasSubstr("roughest along 0 deg from +x, stretched 1.11 times across"));
  EXPECT_THAT(dimension_json(little), HasSubstr("\"anisotropic\": false"));
  EXPECT_THAT(dimension_json(much), HasSubstr("\"anisotropic\": true"));
}

TEST(DimensionReport, TheProbabilityOfAnisotropySaysWhatItRestsOn) {
  Case made = stretched(2.0);
  made.answer.flags = {"no_law_fits"};
  EXPECT_THAT(dimension_line(made.report()), HasSubstr("(p = 1e-09 under one power law)"));
}

TEST(DimensionReport, ContradictedNoiseIsExplained) {
  Case made;
  made.answer.noise_check.emplace();
  made.answer.noise_check->too_large = true;
  made.answer.noise_check->free.noise_sigma_m = 0.0123;
  made.answer.noise_check->free.dimension = 2.345;
  made.answer.noise_check->free.interval95 = {2.3, 2.4};
  EXPECT_THAT(dimension_remarks(made.report()),
              Contains("noise_too_large: the heights show 0.0123 m, and then D = 2.345 (2.300 to 2.400)"));
}

}  // namespace
}  // namespace scree::node
