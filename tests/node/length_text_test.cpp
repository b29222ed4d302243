#include "node/length_text.hpp"

#include <gtest/gtest.h>

namespace scree::node {
namespace {

TEST(LengthText, HasThreeDigitsAndNoExponent) {
  EXPECT_EQ(length_text(0.0003491), "0.000349");
  EXPECT_EQ(length_text(0.5), "0.5");
  EXPECT_EQ(length_text(12.345), "12.3");
  EXPECT_EQ(length_text(100.0), "100");
  EXPECT_EQ(length_text(1649.6), "1650");
  EXPECT_EQ(length_text(0.0), "0");
  EXPECT_EQ(length_text(2e7), "2e+07");
  EXPECT_EQ(range_text(30, 715.8), "30 to 716 m");
}

}  // namespace
}  // namespace scree::node
