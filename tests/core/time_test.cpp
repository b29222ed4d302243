#include "core/time.hpp"

#include <gtest/gtest.h>

namespace scree {
namespace {

TEST(ParseSeconds, IsExactToTheNanosecond) {
  EXPECT_EQ(parse_seconds("1699999999.123456789")->count(), 1699999999123456789);
  EXPECT_EQ(parse_seconds("0")->count(), 0);
  EXPECT_EQ(parse_seconds("-0.5")->count(), -500'000'000);
  EXPECT_EQ(parse_seconds(".25")->count(), 250'000'000);
  EXPECT_EQ(parse_seconds("3.")->count(), 3'000'000'000);
  EXPECT_EQ(parse_seconds("1e-3")->count(), 1'000'000);
  EXPECT_EQ(parse_seconds("0.0000000015")->count(), 2);
}

TEST(ParseSeconds, RefusesWhatIsNotATime) {
  for (const char* text : {"", ".", "-", "1.2.3", "nan", "inf", "12s", " 1", "1e", "1e300", "99999999999"})
    EXPECT_FALSE(parse_seconds(text)) << text;
}

TEST(FormatSeconds, RoundTrips) {
  for (const long long ns : {0LL, 1LL, -1LL, 500'000'000LL, 1699999999123456789LL, -12'000'000'000LL})
    EXPECT_EQ(parse_seconds(format_seconds(Duration(ns)))->count(), ns);
  EXPECT_EQ(format_seconds(Duration(1'500'000'000)), "1.5");
}

}  // namespace
}  // namespace scree
