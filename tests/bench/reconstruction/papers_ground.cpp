#include "tests/bench/reconstruction/papers_ground.hpp"

#include <numbers>

#include "fractal/reconstruction/reconstruct_conditional.hpp"
#include "fractal/successive_random_additions.hpp"

namespace scree::bench {

using namespace fractal;

FractalLaw papers_law(const Grid<float>& surface) {
  double sx = 0, sy = 0;
  constexpr int kLags = 16;
  for (int lag = 1; lag <= kLags; ++lag) {
    double sum = 0, n = 0;
    for (int r = 0; r < surface.rows(); ++r)
      for (int c = 0; c < surface.columns(); ++c) {
        if (c + lag < surface.columns())
          sum += std::abs(static_cast<double>(surface(r, c + lag) - surface(r, c))), n += 1;
        if (r + lag < surface.rows()) sum += std::abs(static_cast<double>(surface(r + lag, c) - surface(r, c))), n += 1;
      }
    sx += std::log(lag), sy += std::log(sum / n);
  }
  const double dimension = axis_dimension(surface);
  const double at_one = std::exp(sy / kLags - (3.0 - dimension) * sx / kLags);
  return {dimension, std::sqrt(std::numbers::pi / 2.0) * at_one};
}

PapersGround papers_ground(std::string name, Grid<float> truth, const FractalLaw& law, std::uint64_t seed) {
  PapersGround ground{std::move(name), std::move(truth), 0.0, law, {}};
  ground.dimension = axis_dimension(ground.truth);
  ground.samples = no_cells(ground.truth.rows(), ground.truth.columns());
  const double sigma = std::sqrt(1e-3) * law.amplitude_m;
  for (int r = 0; r < ground.truth.rows(); ++r)
    for (int c = 0; c < ground.truth.columns(); ++c)
      if (to_uniform(random_words(seed, 5, c, r)[0]) < 0.05)
        measure(ground.samples, r, c,
                static_cast<double>(ground.truth(r, c)) + sigma * random_normals(seed, 6, c, r)[0], sigma * sigma);
  return ground;
}

PapersGround synthetic_ground(bool refined, double dimension, std::uint64_t seed) {
  const FractalLaw law{dimension, 1.0};
  return papers_ground(fmt::format("D = {}", dimension),
                       *(refined ? successive_random_additions(law, kMethodSide, kMethodSide, 1.0, seed)
                                 : fbm_surface(law, kMethodSide, kMethodSide, 1.0, seed)),
                       law, seed);
}

namespace {

void reconstruct(const PapersGround& ground, const Temperature& temperature, int draws,
                 const std::function<void(int, const Grid<float>&)>& on_draw) {
  SerialExecutor serial;
  SurfaceRequest request;
  request.grid = {ground.truth.rows(), ground.truth.columns(), 1.0};
  request.law.law = ground.law;
  request.draws = draws;
  request.on_draw = on_draw;
  (void)reconstruct_szeliski(ground.samples, request, {temperature, 20, true}, serial);
}

}  // namespace

double papers_dimension(const PapersGround& ground, const Temperature& temperature) {
  constexpr int kDraws = 8;
  double sum = 0.0;
  reconstruct(ground, temperature, kDraws,
              [&](int, const Grid<float>& draw_m) { sum += axis_dimension(draw_m) / kDraws; });
  return sum;
}

double conditional_dimension(const PapersGround& ground) {
  constexpr int kDraws = 8;
  SerialExecutor serial;
  SurfaceRequest request;
  request.grid = {ground.truth.rows(), ground.truth.columns(), 1.0};
  request.law.law = ground.law;
  request.draws = kDraws;
  double sum = 0.0;
  request.on_draw = [&](int, const Grid<float>& draw_m) { sum += axis_dimension(draw_m) / kDraws; };
  (void)reconstruct_conditional(ground.samples, request, {}, serial);
  return sum;
}

Grid<float> papers_surface(const PapersGround& ground, const Temperature& temperature) {
  Grid<float> surface;
  reconstruct(ground, temperature, 1, [&](int, const Grid<float>& draw_m) { surface = draw_m; });
  return surface;
}

Temperature relative(const PapersGround& ground, double ratio) {
  return {Temperature::Kind::fixed, ratio * ground.law.amplitude_m * ground.law.amplitude_m};
}

double search_temperature(const std::vector<PapersGround>& grounds) {
  double low = std::log(0.005), high = std::log(20.0);
  for (int step = 0; step < 10; ++step) {
    const double middle_of = 0.5 * (low + high);
    double bias = 0.0;
    for (const double one : over_surfaces(static_cast<int>(grounds.size()), [&](int i) {
           const PapersGround& ground = grounds[static_cast<std::size_t>(i)];
           return papers_dimension(ground, relative(ground, std::exp(middle_of))) - ground.dimension;
         }))
      bias += one;
    (bias > 0.0 ? high : low) = middle_of;
  }
  return std::exp(0.5 * (low + high));
}

}  // namespace scree::bench
