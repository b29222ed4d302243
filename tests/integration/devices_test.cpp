// scree devices, on whatever machine this is.

#include <nlohmann/json.hpp>

#include "tests/integration/scree.hpp"

namespace scree {
namespace {

TEST(Devices, AreListedAndTheirAbsenceIsNoFailure) {
  const auto text = test::scree({"devices"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_FALSE(text.out.empty());
  const auto json = test::scree({"devices", "--json"});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  const auto document = nlohmann::json::parse(json.out, nullptr, false);
  ASSERT_TRUE(document.is_object()) << json.out;
  EXPECT_TRUE(document.at("v4l2").is_array());
  EXPECT_TRUE(document.at("usb").is_array());
  EXPECT_TRUE(document.at("usb_error").is_string());
  EXPECT_EQ(document.size(), 3u);
}

}  // namespace
}  // namespace scree
