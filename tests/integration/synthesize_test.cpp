// scree synthesize, end to end.

#include <gmock/gmock.h>

#include "tests/integration/scree.hpp"

namespace scree::test {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> synthesize(const std::string& model, const std::string& out,
                                    const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"synthesize",    "--model", model,    "--dimension", "2.3",
                                     "--amplitude-m", "0.1",     "--size", "40",          "--cell",
                                     "0.05",          "--out",   out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Synthesize, WritesEveryModelInEveryFormat) {
  const TemporaryFolder folder;
  for (const std::string model : {"fbm", "sra", "midpoint-square", "midpoint-triangle"})
    for (const std::string extension : {".npy", ".tif", ".png"}) {
      const auto file = folder / (model + extension);
      const auto made = scree(synthesize(model, file.string()));
      EXPECT_EQ(made.exit_code, 0) << made.err;
      EXPECT_GT(std::filesystem::file_size(file), 500u) << file;
    }
  const std::string npy = read_file(folder / "sra.npy");
  EXPECT_THAT(npy.substr(0, 128), HasSubstr("'shape': (40, 40)"));
}

TEST(Synthesize, IsRepeatableFromTheSeed) {
  const TemporaryFolder folder;
  const auto bytes = [&](const std::string& name, const std::string& seed) {
    const auto made = scree(synthesize("sra", (folder / name).string(), {"--seed", seed}));
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return read_file(folder / name);
  };
  const std::string first = bytes("a.npy", "7");
  EXPECT_EQ(first, bytes("b.npy", "7"));
  EXPECT_NE(first, bytes("c.npy", "8"));
}

TEST(Synthesize, CombinedSurfacesTakeAnHForEachAxis) {
  const TemporaryFolder folder;
  const auto combined = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "synthesize", "--model", "combined", "--amplitude-m",        "0.1", "--size", "40",
        "--cell",     "0.05",    "--out",    (folder / out).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return scree(arguments);
  };
  for (const std::string extension : {".npy", ".tif", ".png"}) {
    const auto made =
        combined("c" + extension, {"--hx", "0.3", "--hy", "0.6", "--weight", "0.4", "--correlation", "0.8"});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EXPECT_GT(std::filesystem::file_size(folder / ("c" + extension)), 500u);
  }
  const auto fails = [&](const Finished& made, const std::string& message) {
    EXPECT_EQ(made.exit_code, 64);
    EXPECT_THAT(made.err, HasSubstr(message));
  };
  fails(combined("d.npy", {"--hx", "0.3"}), "--model combined: --hy is required");
  fails(combined("d.npy", {"--hx", "0.3", "--hy", "0.6", "--dimension", "2.5"}), "--dimension does not go with it");
  fails(combined("d.npy", {"--hx", "0.3", "--hy", "1.6"}), "expected 0 < H < 1, found H = 1.6");
  fails(combined("d.npy", {"--hx", "0.2", "--hy", "0.9", "--correlation", "0.8"}),
        "expected a correlation of at most 0.49");
  fails(scree(synthesize("fbm", (folder / "d.npy").string(), {"--hx", "0.3"})),
        "--model fbm: --hx does not go with it");
  fails(scree({"synthesize", "--model", "sra", "--amplitude-m", "0.1", "--size", "40", "--cell", "0.05", "--out",
               (folder / "d.npy").string()}),
        "--model sra: --dimension is required");
  EXPECT_FALSE(std::filesystem::exists(folder / "d.npy"));
}

TEST(Synthesize, BadValuesAre64AndBadPlaces73) {
  const TemporaryFolder folder;
  const std::string out = (folder / "z.npy").string();
  const auto fails = [&](const std::string& option, const std::string& value, const std::string& message) {
    std::vector<std::string> arguments = synthesize("sra", out);
    *(std::find(arguments.begin(), arguments.end(), option) + 1) = value;
    const auto made = scree(arguments);
    EXPECT_EQ(made.exit_code, 64) << option << ' ' << value;
    EXPECT_THAT(made.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  fails("--model", "perlin", "--model");
  fails("--dimension", "3.2", "expected 2 < D < 3, found D = 3.2");
  fails("--amplitude-m", "-1", "expected a finite amplitude_m > 0, found -1");
  fails("--size", "1", "--size 1: expected at least 2 values a side");
  fails("--size", "0", "--size 0: expected at least 2 values a side");
  fails("--cell", "0", "expected a finite cell_m > 0, found 0");
  fails("--out", (folder / "z.bmp").string(), "expected a file that ends in .tif, .npy or .png");
  EXPECT_EQ(scree(synthesize("fbm", "/nowhere/z.npy")).exit_code, 73);
}

}  // namespace
}  // namespace scree::test
