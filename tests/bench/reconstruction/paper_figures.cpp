// Figures 13, 15 and 17 of [AK96], and what the surfaces look like.

#include <filesystem>

#include "io/loglog_plot.hpp"
#include "io/picture.hpp"
#include "tests/bench/reconstruction/papers_ground.hpp"

namespace scree::bench {
namespace {

using namespace fractal;

constexpr std::array kDimensions = {2.1, 2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8};
constexpr Temperature kEmpirical{Temperature::Kind::empirical, 0.0}, kFormula{Temperature::Kind::formula, 0.0},
    kZero{Temperature::Kind::fixed, 0.0};
// viridis, dark to light
constexpr std::array<io::Colour, kDimensions.size()> kColours = {{{68, 1, 84},
                                                                  {70, 50, 127},
                                                                  {54, 92, 141},
                                                                  {39, 127, 142},
                                                                  {31, 161, 135},
                                                                  {74, 194, 109},
                                                                  {159, 218, 58},
                                                                  {220, 200, 30}}};

/// Mean absolute height change at lags 1 … 64 along the axes.
std::vector<io::PlotPoint> scaling(const Grid<float>& z) {
  std::vector<io::PlotPoint> points;
  for (const int lag : {1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64}) {
    double sum = 0, n = 0;
    for (int r = 0; r < z.rows(); ++r)
      for (int c = 0; c < z.columns(); ++c) {
        if (c + lag < z.columns()) sum += std::abs(static_cast<double>(z(r, c + lag) - z(r, c))), n += 1;
        if (r + lag < z.rows()) sum += std::abs(static_cast<double>(z(r + lag, c) - z(r, c))), n += 1;
      }
    points.push_back({static_cast<double>(lag), sum / n});
  }
  return points;
}

using Surfaces = std::vector<Grid<float>>;

io::Drawing scaling_plot(const std::string& title, const Surfaces& surfaces) {
  io::LogLogPlot plot;
  plot.title = title;
  plot.subtitle = "256 x 256 cells; D^ from lags 1 ... 16";
  plot.x_label = "lag (cells)";
  plot.y_label = "mean absolute height change (rms change of the ground over one cell = 1)";
  plot.marks.push_back({});
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const auto points = scaling(surfaces[i]);
    plot.lines.push_back({points, kColours[i], false,
                          fmt::format("D = {:.1f}, D^ = {:.3f}", kDimensions[i], axis_dimension(surfaces[i]))});
    plot.marks[0].points.insert(plot.marks[0].points.end(), points.begin(), points.end());
  }
  return io::draw_loglog_plot(plot);
}

io::Drawing beside(io::Drawing left, const io::Drawing& right) {
  const auto moved = [&](io::PixelPoint p) { return io::PixelPoint{p.x_px + left.width_px, p.y_px}; };
  for (io::Shape shape : right.shapes) {
    if (auto* stroke = std::get_if<io::Stroke>(&shape))
      for (auto& p : stroke->points) p = moved(p);
    if (auto* area = std::get_if<io::Area>(&shape))
      for (auto& p : area->corners) p = moved(p);
    if (auto* disc = std::get_if<io::Disc>(&shape)) disc->centre = moved(disc->centre);
    if (auto* label = std::get_if<io::Label>(&shape)) label->at = moved(label->at);
    left.shapes.push_back(std::move(shape));
  }
  left.width_px += right.width_px;
  left.height_px = std::max(left.height_px, right.height_px);
  return left;
}

void report(const std::filesystem::path& file, const Status& status) {
  print_text(status ? fmt::format("\n![{0}]({0})", file.filename().string())
                    : "\nNo picture: " + status.error().message);
}

void map_picture(const std::filesystem::path& file, const PapersGround& ground) {
  const auto panel = [&](const std::string& title, Grid<float> values) {
    io::PicturePanel out{title, std::move(values), {}};
    out.scale.map = io::ColourMap::viridis;
    const auto [low, high] = std::minmax_element(ground.truth.begin(), ground.truth.end());
    out.scale.min = static_cast<double>(*low), out.scale.max = static_cast<double>(*high);
    return out;
  };
  report(file,
         io::write_map_picture(file,
                               {panel("ground (m)", ground.truth), panel("samples (m)", ground.samples.height_m),
                                panel("T = 0 (m)", papers_surface(ground, kZero)),
                                panel("T of the formula (m)", papers_surface(ground, kFormula))},
                               {0.0, 0.0, 1.0}, std::nullopt,
                               fmt::format("{}, cells of 1 m, rms change over one cell 1 m, 5 % known", ground.name)));
}

}  // namespace

void write_paper_figures() {
  const std::filesystem::path folder = pictures;
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  const std::vector<PapersGround> grounds = over_surfaces(static_cast<int>(kDimensions.size()), [](int i) {
    return synthetic_ground(true, kDimensions[static_cast<std::size_t>(i)], 1);
  });
  const auto reconstructed = [&](const Temperature& temperature) {
    return over_surfaces(static_cast<int>(grounds.size()),
                         [&](int i) { return papers_surface(grounds[static_cast<std::size_t>(i)], temperature); });
  };
  Surfaces originals;
  for (const PapersGround& ground : grounds) originals.push_back(ground.truth);
  const auto write = [&](const std::string& name, const io::Drawing& drawing) {
    report(folder / name, io::write_drawing(folder / name, drawing));
  };
  write("szeliski-relaxed.png", beside(scaling_plot("Original surfaces", originals),
                                       scaling_plot("Reconstructed, T = 0", reconstructed(kZero))));
  write("szeliski-temperatures.png",
        beside(scaling_plot("Reconstructed, empirical temperatures", reconstructed(kEmpirical)),
               scaling_plot("Reconstructed, T of the formula", reconstructed(kFormula))));
  map_picture(folder / "szeliski-surfaces.png", grounds[4]);
}

}  // namespace scree::bench
