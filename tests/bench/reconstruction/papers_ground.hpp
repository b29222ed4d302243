#pragma once
// Ground as [AK96] has it, and its estimator: a cell is the unit of length.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "fractal/reconstruction/szeliski.hpp"
#include "tests/bench/reconstruction/method_scores.hpp"

namespace scree::bench {

/// Surface, the cells of it that are known, and what the paper estimates from all of it: D* by the first absolute
/// moment over lags 1 … 16 and σ0, the rms change over one cell, from the same line.
struct PapersGround {
  std::string name;
  Grid<float> truth;
  double dimension = 0.0;   ///< D*
  fractal::FractalLaw law;  ///< given to the reconstruction; amplitude = σ0
  fractal::CellSamples samples;
};

/// Yokoya's line: D and σ0 (Gaussian increments: rms = √(π/2) · mean absolute).
fractal::FractalLaw papers_law(const Grid<float>& surface);

/// `law` is given to the reconstruction; 5 % of the cells, noise variance 1e-3·σ0².
PapersGround papers_ground(std::string name, Grid<float> truth, const fractal::FractalLaw& law, std::uint64_t seed);

/// A synthetic surface of 256 × 256 cells with σ0 = 1; the law given is its own. `refined`: successive random
/// additions, as in the paper; else exact.
PapersGround synthetic_ground(bool refined, double dimension, std::uint64_t seed);

/// D^ of the reconstruction at a temperature, mean of 8 draws; 20 sweeps, which is as good as more.
double papers_dimension(const PapersGround& ground, const fractal::Temperature& temperature);
/// The same of the conditional method.
double conditional_dimension(const PapersGround& ground);
/// One surface of the reconstruction at a temperature.
Grid<float> papers_surface(const PapersGround& ground, const fractal::Temperature& temperature);

/// T/σ0² at which D^ = D*, in the mean over `grounds`.
double search_temperature(const std::vector<PapersGround>& grounds);

/// Temperature of a ground from a multiple of its σ0².
fractal::Temperature relative(const PapersGround& ground, double ratio);

/// [AK96] figures 13, 15, 17 as PNG in `pictures`.
void write_paper_figures();

}  // namespace scree::bench
